//! What is stored on board besides parameters: mission, fence, rally points, item by item.

use windhover_autopilot::mission::MissionItem;
pub use windhover_autopilot::mission::PlanKind;

use crate::record;
use crate::record::{Description, Field, Record, Topic};
use crate::value::Value;
use crate::wire::{Decoder, Encoder};

record!(MissionItem {
    command: u16,
    frame: u8,
    autocontinue: bool,
    params: [f32; 4],
    x: i32,
    y: i32,
    z: f32
});

/// A list of items as it is stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// What it is.
    pub kind: PlanKind,
    /// The storage slot that holds it.
    pub slot: u8,
    /// How many items it has.
    pub count: u16,
}

/// One item with its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanItem {
    /// What it belongs to.
    pub kind: PlanKind,
    /// The storage slot.
    pub slot: u8,
    /// Its index there.
    pub index: u16,
    /// The item.
    pub item: MissionItem,
}

const OWN: [Field; 3] = [
    Field::of::<u8>("kind"),
    Field::of::<u8>("slot"),
    Field::of::<u16>("index"),
];

const FIELDS: [Field; 10] = {
    let item = MissionItem::FIELDS;
    [
        OWN[0], OWN[1], OWN[2], item[0], item[1], item[2], item[3], item[4], item[5], item[6],
    ]
};

impl Record for PlanItem {
    const FIELDS: &'static [Field] = &FIELDS;

    fn put(&self, out: &mut Encoder<'_>) {
        self.kind.code().put(out);
        self.slot.put(out);
        self.index.put(out);
        self.item.put(out);
    }

    fn get(from: &mut Decoder<'_>) -> Option<Self> {
        Some(Self {
            kind: PlanKind::from_code(Value::get(from)?)?,
            slot: Value::get(from)?,
            index: Value::get(from)?,
            item: Record::get(from)?,
        })
    }
}

impl Topic for PlanItem {
    const TOPIC: Description = Description {
        id: 5,
        name: "mission_item",
        ticked: false,
        fields: Self::FIELDS,
    };
}
