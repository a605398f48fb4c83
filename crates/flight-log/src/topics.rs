//! All topics that we write.

use windhover_autopilot::Urgent;

use crate::batch::{ImuBatch, ImuTimes};
use crate::motors::MotorBatch;
use crate::plan::PlanItem;
use crate::record::{Description, Topic};
use crate::{inputs, views};

const OWN: [Description; 5] = [
    ImuBatch::TOPIC,
    ImuTimes::TOPIC,
    MotorBatch::TOPIC,
    PlanItem::TOPIC,
    Urgent::TOPIC,
];

/// Every topic, inputs before outputs.
pub fn all() -> impl Iterator<Item = Description> + Clone {
    let inputs = inputs::TOPICS.iter().copied();
    OWN.into_iter().chain(inputs).chain(views::TOPICS.iter().copied())
}

/// The topic with that name.
pub fn find(name: &str) -> Option<Description> {
    all().find(|topic| topic.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::header::CHUNK;
    use crate::wire::Encoder;
    use std::collections::BTreeSet;

    #[test]
    fn names_and_numbers_are_unique_and_formats_fit_a_chunk() {
        let (mut names, mut ids) = (BTreeSet::new(), BTreeSet::new());
        for topic in all() {
            assert!(names.insert(topic.name), "{} is there twice", topic.name);
            assert!(ids.insert(topic.id), "{}: its number is taken", topic.name);
            let mut buffer = [0; CHUNK - 3];
            let mut out = Encoder::new(&mut buffer);
            topic.format(16, &mut out);
            assert!(out.finish().is_some(), "{}: format too long", topic.name);
        }
    }

    /// The budget of a message on the wire: header 3, number 2.
    #[test]
    fn batches_are_as_small_as_planned() {
        assert_eq!(5 + ImuBatch::TOPIC.size(4), 71);
        assert_eq!(5 + MotorBatch::TOPIC.size(4), 52);
        assert_eq!(5 + ImuBatch::TOPIC.size(16), 227);
        assert_eq!(5 + MotorBatch::TOPIC.size(16), 151);
    }
}
