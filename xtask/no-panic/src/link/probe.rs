//! What the linker sees around the link: an entry that calls it, the place where it is kept, and
//! the panic handler.

// Linking is the purpose here: a name for the entry, and a symbol that does not exist.
#![allow(unsafe_code)]

use core::hint::black_box;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use windhover_ground_link::parameters::{Appended, QGROUNDCONTROL};
use windhover_ground_link::{Config, Context, Link, Photo, Signing, Telemetry};
use windhover_math::Quaternion;
use windhover_math::geodesy::GlobalPosition;

use crate::entries::{link_key, link_poll, link_receive, link_requests, link_tell};
use crate::vehicle::{Plans, Table};

/// Where the firmware keeps a link: the RAM that counts.
static mut LINK: MaybeUninit<Link> = MaybeUninit::uninit();

/// One for all links.
static mut SIGNING: MaybeUninit<Signing> = MaybeUninit::uninit();

/// The entry: the link for ever, on inputs that the optimiser knows nothing about.
#[unsafe(no_mangle)]
extern "C" fn reset() -> ! {
    let (signing, link) = (&raw mut SIGNING, &raw mut LINK);
    // SAFETY: this is the only place that names them, and it is entered once.
    let (signing, link) = unsafe { (&mut *signing, &mut *link) };
    let signing = signing.write(Signing::default());
    let link = link.write(Link::new(black_box(Config::default())));
    let (mut telemetry, mut plans) = (Telemetry::default(), Plans);
    let bytes = [0; 64];
    loop {
        let now = black_box(0);
        black_box(&mut telemetry);
        let mut context = Context {
            telemetry: &telemetry,
            parameters: &Appended {
                table: &Table,
                constants: QGROUNDCONTROL,
            },
            plans: &mut plans,
            signing,
        };
        link_receive(link, black_box(&bytes), now, &mut context);
        link_requests(link, now, &context);
        link_poll(link, now, &mut context);
        black_box(link_key(signing, now));
        black_box(link_tell(link, black_box(PHOTO)));
    }
}

const PHOTO: Photo = Photo {
    index: 0,
    time: 0,
    position: GlobalPosition {
        latitude: 0,
        longitude: 0,
        altitude: 0,
    },
    attitude: Quaternion::IDENTITY,
};

unsafe extern "C" {
    /// Defined nowhere: the linker names it when the link can panic.
    safe fn windhover_step_can_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    windhover_step_can_panic()
}
