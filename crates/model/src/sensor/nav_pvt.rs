//! The message UBX-NAV-PVT: fields, units and integer sizes as in the interface description of
//! u-blox M10.

/// In `flags`: the fix is within the receiver's limits.
pub const GNSS_FIX_OK: u8 = 1 << 0;

/// In `flags`: differential corrections are used.
pub const DIFFERENTIAL: u8 = 1 << 1;

/// In `flags`: the carrier-phase ambiguities are fixed.
pub const CARRIER_FIXED: u8 = 2 << 6;

/// `fix_type` of a fix in three dimensions.
pub const FIX_3D: u8 = 3;

/// Fields of UBX-NAV-PVT, as integers of its units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NavPvt {
    /// iTOW: GPS time of week of the moment described, in ms.
    pub time_of_week: u32,
    /// lat, in 1e-7 degrees.
    pub latitude: i32,
    /// lon, in 1e-7 degrees.
    pub longitude: i32,
    /// height above the ellipsoid, in mm.
    pub height: i32,
    /// hMSL: height above mean sea level, in mm.
    pub height_msl: i32,
    /// hAcc: what the receiver says is its horizontal error (the two axes together), in mm.
    pub horizontal_accuracy: u32,
    /// vAcc: what it says is its vertical error, in mm.
    pub vertical_accuracy: u32,
    /// velN, velE, velD, in mm/s.
    pub velocity: [i32; 3],
    /// gSpeed: speed over ground, in mm/s.
    pub ground_speed: i32,
    /// headMot: heading of the motion, 0 to 360°, in 1e-5 degrees.
    pub heading_of_motion: i32,
    /// sAcc: what it says is the error of its speed (the three axes together), in mm/s.
    pub speed_accuracy: u32,
    /// headAcc: what it says is the error of the heading of motion, in 1e-5 degrees.
    pub heading_accuracy: u32,
    /// pDOP, in hundredths.
    pub position_dop: u16,
    /// fixType: 3 is a fix in three dimensions.
    pub fix_type: u8,
    /// flags: [`GNSS_FIX_OK`], [`DIFFERENTIAL`], [`CARRIER_FIXED`].
    pub flags: u8,
    /// numSV: satellites used.
    pub satellites: u8,
}
