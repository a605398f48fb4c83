//! The three models behind one step.

use crate::body::{Body, Outside};
use crate::integrate::{Integrator, SixDegrees, step};
use crate::kinematics::Kinematics;
use crate::rotor::{RotorForces, StepSpeeds};
use crate::{paper, rigid, simple};

/// Which equations move the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ModelKind {
    /// Equation (1): angles that turn independently.
    Simple,
    /// Equation (8): Euler angles and their rates.
    Paper,
    /// A full rigid body.
    #[default]
    Rigid,
}

/// The state of a model where it is not that of [`Kinematics`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum Motion {
    Simple(SixDegrees),
    Paper(SixDegrees),
    Rigid,
}

/// What acts on the vehicle during a step.
pub(crate) struct Acting<'a> {
    /// Mass, inertia, drag.
    pub body: &'a Body,
    /// What the rotors make of their speeds.
    pub forces: &'a RotorForces,
    /// The rotor speeds during the step.
    pub speeds: &'a StepSpeeds,
    /// Wind and external forces.
    pub outside: &'a Outside,
}

impl Motion {
    /// The motion that starts from `state`.
    pub(crate) fn new(kind: ModelKind, state: &Kinematics) -> Self {
        match kind {
            ModelKind::Simple => Self::Simple(simple::from_kinematics(state)),
            ModelKind::Paper => Self::Paper(paper::from_kinematics(state)),
            ModelKind::Rigid => Self::Rigid,
        }
    }

    /// The state `dt` seconds after `state`.
    #[inline(always)]
    pub(crate) fn step(
        &mut self,
        integrator: Integrator,
        dt: f64,
        state: &Kinematics,
        acting: &Acting<'_>,
    ) -> Kinematics {
        let Acting {
            body,
            forces,
            speeds,
            outside,
        } = acting;
        match self {
            Self::Rigid => step(integrator, *state, dt, |state, stage| {
                rigid::derivative(body, state, &forces.wrench(speeds.at(stage)), outside)
            }),
            Self::Paper(own) => {
                *own = step(integrator, *own, dt, |state, stage| {
                    paper::derivative(body, state, &forces.wrench(speeds.at(stage)), outside)
                });
                paper::to_kinematics(own)
            }
            Self::Simple(own) => {
                *own = step(integrator, *own, dt, |state, stage| {
                    simple::derivative(body, state, &forces.wrench(speeds.at(stage)), outside)
                });
                simple::to_kinematics(own)
            }
        }
    }
}
