//! What a vehicle calls of the link, each a function of its own in the ELF.

// The names are for the reader of the ELF and for xtask, which looks whether they are in it.
#![allow(unsafe_code)]

use core::hint::black_box;

use windhover_ground_link::{CommandResult, Context, Counters, Link, Photo, Severity, Signing};

/// Bytes that have come.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn link_receive(link: &mut Link, bytes: &[u8], now: u64, context: &mut Context<'_>) {
    #[cfg(feature = "prove-it-fails")]
    let _ = black_box(bytes.first()).unwrap();
    link.receive(bytes, now, context);
    link.receive_packet(bytes, now, context);
}

/// Frames that are to be sent.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn link_poll(link: &mut Link, now: u64, context: &mut Context<'_>) {
    link.poll(now, context, &mut |frame| {
        black_box(frame);
    });
}

/// Requests, and their answers.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn link_requests(link: &mut Link, now: u64, context: &Context<'_>) {
    while let Some(order) = link.next_request() {
        if let Some(id) = black_box(order).id {
            link.progress(id, black_box(10), now);
            link.finish(id, black_box(CommandResult::Accepted), now);
        }
        let refusal = black_box(windhover_parameters::Refusal::Unknown);
        link.parameter_refused(black_box(0), refusal, context.parameters, now);
    }
}

/// The key of signatures.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn link_key(signing: &mut Signing, now: u64) -> Option<u64> {
    signing.set_key(black_box([1; 32]), black_box(1), now);
    black_box(signing.refusals());
    signing.time(now)
}

/// Everything that is told on occasion.
#[inline(never)]
#[unsafe(no_mangle)]
pub fn link_tell(link: &mut Link, photo: Photo) -> Counters {
    link.say(black_box(Severity::Info), format_args!("ready"));
    link.item_reached(black_box(1));
    link.parameter_changed(black_box(1));
    link.photo_taken(photo);
    link.set_identity(black_box(windhover_ground_link::Identity::Generic));
    black_box(link.station_heard());
    link.counters()
}
