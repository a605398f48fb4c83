//! The world: a vehicle, the air and the ground, stepped forward by motor commands.

use windhover_math::{Quaternion, Vector3};

use crate::GRAVITY;
use crate::body::{Body, Outside};
use crate::conditions::Conditions;
use crate::divergence::{Divergence, divergence, is_sound};
use crate::esc::{Command, Esc, PwmLatch};
use crate::ground::{self, Contact, Crash};
use crate::integrate::Integrator;
use crate::kinematics::Kinematics;
use crate::motion::{Acting, ModelKind, Motion};
use crate::push::Pushes;
use crate::random::Random;
use crate::rotor::{LagStep, RotorForces, StepSpeeds};
use crate::truth::{Truth, halfway, turn};
use crate::vehicle::Plant;
use crate::wind::Wind;

/// Step length with what follows from it.
#[derive(Clone, Copy, Debug)]
struct Span {
    ns: u64,
    dt: f64,
    inverse_dt: f64,
    lag: LagStep,
}

impl Span {
    fn new(plant: &Plant, ns: u64) -> Self {
        let dt = ns as f64 / 1e9;
        Self {
            ns,
            dt,
            inverse_dt: 1.0 / dt,
            lag: LagStep::new(plant, dt),
        }
    }
}

/// One vehicle in its world. Deterministic: equal arguments give equal bits.
#[derive(Clone, Debug)]
pub struct World {
    plant: Plant,
    body: Body,
    forces: RotorForces,
    esc: Esc,
    wind: Wind,
    pushes: Pushes,
    disturbance: Vector3<f64>,
    kind: ModelKind,
    motion: Motion,
    integrator: Integrator,
    span: Span,
    time_ns: u64,
    rotor_speed: [f64; 4],
    state: Kinematics,
    /// The state before the last step.
    previous: Kinematics,
    contact: Contact,
    crash: Option<Crash>,
    divergence: Option<Divergence>,
    power: f64,
    energy: f64,
}

impl World {
    /// A vehicle at rest on the ground at the origin, facing north, rotors standing.
    ///
    /// `plant` and `conditions` should have passed their `validate`; other figures do not panic,
    /// but may diverge at once.
    ///
    /// ```
    /// use windhover_model::{Conditions, Integrator, ModelKind, Vehicle, World};
    /// let vehicle = Vehicle::named("os4").unwrap();
    /// let conditions = Conditions::reference();
    /// let mut world = World::new(&vehicle.plant, ModelKind::Rigid, Integrator::Rk4, &conditions);
    /// for _ in 0..1000 {
    ///     world.step(1e-3, Some([40_000; 4]));
    /// }
    /// assert!(world.truth().position.z < -0.5, "it climbs");
    /// ```
    pub fn new(plant: &Plant, kind: ModelKind, integrator: Integrator, conditions: &Conditions) -> Self {
        let random = Random::new(conditions.seed, 0);
        Self {
            plant: plant.clone(),
            body: Body::new(plant, conditions.payload),
            forces: RotorForces::new(plant),
            esc: Esc::new(plant.rotor_speed_max, PwmLatch::new(conditions.pwm_hz)),
            wind: Wind::new(conditions.wind, conditions.gust, random),
            pushes: Pushes::new(&conditions.pushes),
            disturbance: conditions.disturbance,
            kind,
            motion: Motion::new(kind, &Kinematics::default()),
            integrator,
            span: Span::new(plant, 1_000_000),
            time_ns: 0,
            rotor_speed: [0.0; 4],
            state: Kinematics::default(),
            previous: Kinematics::default(),
            contact: Contact::Resting,
            crash: None,
            divergence: None,
            power: 0.0,
            energy: 0.0,
        }
    }

    /// The same world with the vehicle in flight in the given state, its rotors at the given
    /// speeds in rad/s.
    pub fn in_flight(mut self, state: Kinematics, rotor_speed: [f64; 4]) -> Self {
        self.state = state;
        self.previous = state;
        self.rotor_speed = rotor_speed;
        self.take_off();
        self
    }

    /// The same world with the vehicle turned on the ground to a heading in rad.
    pub fn facing(mut self, heading: f64) -> Self {
        self.state.attitude = Quaternion::from_heading(heading);
        self.previous = self.state;
        self
    }

    /// Rotor speed in rad/s at which vehicle and payload hover.
    pub fn hover_speed(&self) -> f64 {
        (self.body.mass * GRAVITY / (4.0 * self.plant.k_f)).sqrt()
    }

    /// Moves the world `dt` seconds forward (0 to 1, rounded to whole nanoseconds) while
    /// `command` is written to the motors. After a crash or a divergence only time goes on.
    #[inline(always)]
    pub fn step(&mut self, dt: f64, command: Command) {
        let ns = (dt.clamp(0.0, 1.0) * 1e9 + 0.5) as u64;
        if ns != self.span.ns {
            if ns == 0 {
                return;
            }
            self.span = Span::new(&self.plant, ns);
        }
        let (span, start_ns) = (self.span, self.time_ns);
        self.time_ns += span.ns;
        self.previous = self.state;
        if self.crash.is_some() || self.divergence.is_some() {
            return;
        }
        self.wind
            .advance(start_ns, -self.state.position.z, self.state.velocity);
        let target = self.esc.step(start_ns, span.ns, command);
        let middle = span.lag.half(&self.rotor_speed, &target);
        let end = span.lag.half(&middle, &target);
        let speeds = StepSpeeds {
            start: self.rotor_speed,
            middle,
            end,
        };
        self.rotor_speed = end;
        self.power = self.forces.power(&middle);
        self.energy += self.power * span.dt;
        let outside = Outside {
            wind: self.wind.velocity(),
            force: self.pushes.mean_force(start_ns, span.ns),
            acceleration: self.disturbance,
        };
        match self.contact {
            Contact::Flying => self.fly(&speeds, &outside),
            Contact::Settling => (self.state, self.contact) = ground::settle(&self.state, span.dt),
            Contact::Resting => self.rest(&speeds, &outside),
        }
    }

    #[inline(always)]
    fn fly(&mut self, speeds: &StepSpeeds, outside: &Outside) {
        let (integrator, dt) = (self.integrator, self.span.dt);
        let acting = Acting {
            body: &self.body,
            forces: &self.forces,
            speeds,
            outside,
        };
        let next = self.motion.step(integrator, dt, &self.state, &acting);
        if is_sound(&next) {
            self.state = next;
            if ground::is_touchdown(&self.state) {
                self.touch_down();
            }
        } else {
            self.divergence = Some(divergence(&next, self.time()));
        }
    }

    /// From here on the model moves the vehicle.
    fn take_off(&mut self) {
        self.contact = Contact::Flying;
        self.motion = Motion::new(self.kind, &self.state);
    }

    /// On the ground until the vertical force points up.
    fn rest(&mut self, speeds: &StepSpeeds, outside: &Outside) {
        let thrust = self.forces.wrench(&speeds.middle).thrust;
        let down = self.body.outside_acceleration(Vector3::zeros(), outside).z;
        if thrust / self.body.mass > down {
            self.take_off();
            self.fly(speeds, outside);
        }
    }

    #[cold]
    fn touch_down(&mut self) {
        self.contact = Contact::Settling;
        self.crash = ground::crash(&self.state, self.time());
        if self.crash.is_some() {
            self.state.velocity = Vector3::zeros();
            self.state.body_rate = Vector3::zeros();
            self.rotor_speed = [0.0; 4];
            self.power = 0.0;
        }
    }

    /// Time since the start in s.
    #[inline]
    pub fn time(&self) -> f64 {
        self.time_ns as f64 / 1e9
    }

    /// Where the vehicle is in relation to the ground.
    pub fn contact(&self) -> Contact {
        self.contact
    }

    /// The crash that ended the flight, if there was one.
    pub fn crash(&self) -> Option<Crash> {
        self.crash
    }

    /// What diverged and when, if something did.
    pub fn diverged(&self) -> Option<Divergence> {
        self.divergence
    }

    /// Position, velocity, attitude and rate.
    pub fn kinematics(&self) -> Kinematics {
        self.state
    }

    /// Everything there is to know now.
    #[inline]
    pub fn truth(&self) -> Truth {
        let (now, before, per_step) = (&self.state, &self.previous, self.span.inverse_dt);
        let mut acceleration = (now.velocity - before.velocity) * per_step;
        acceleration.z -= GRAVITY;
        let middle = halfway(before.attitude, now.attitude);
        Truth {
            time: self.time(),
            position: now.position,
            velocity: now.velocity,
            attitude: now.attitude,
            body_rate: now.body_rate,
            mean_rate: turn(before.attitude, now.attitude) * per_step,
            specific_force: middle.inverse_rotate(acceleration),
            rotor_speed: self.rotor_speed,
            wind: self.wind.velocity(),
            power: self.power,
            energy: self.energy,
        }
    }
}
