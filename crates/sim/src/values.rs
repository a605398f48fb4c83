//! Values on the command line: what they mean, and what is wrong with them.

use std::fmt;
use std::net::{SocketAddr, ToSocketAddrs};
use std::str::FromStr;

use windhover_autopilot::Parameters;
use windhover_math::geodesy::GlobalPosition;

use crate::reference;

/// A parameter and its value.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Index in the table.
    pub index: usize,
    /// Its name.
    pub name: &'static str,
    /// The value, inside the range.
    pub value: f32,
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("NAME=VALUE is wanted")?;
        let (index, declaration) = Parameters::declarations()
            .enumerate()
            .find(|(_, declaration)| declaration.name == name)
            .ok_or_else(|| reference::unknown(name))?;
        let value: f32 = value
            .parse()
            .map_err(|_| format!("{name}: '{value}' is not a number"))?;
        declaration
            .check(value)
            .map_err(|refusal| format!("{name}: {refusal}"))?;
        let name = declaration.name;
        Ok(Self { index, name, value })
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.name, self.value)
    }
}

/// A share in percent, 0 to 100.
#[derive(Clone, Copy, Debug)]
pub struct Percent(pub f64);

impl FromStr for Percent {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = text.trim_end_matches('%').trim();
        match number.parse::<f64>() {
            Ok(percent) if (0.0..=100.0).contains(&percent) => Ok(Self(percent)),
            Ok(percent) if !percent.is_nan() => Err(format!("{percent} % is outside 0 to 100")),
            _ => Err(format!("'{text}' is not a number")),
        }
    }
}

/// Numbers with commas between them, all finite.
#[derive(Clone, Copy, Debug)]
pub struct Numbers<const N: usize>(pub [f64; N]);

impl<const N: usize> FromStr for Numbers<N> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f64>, String> = text
            .split(',')
            .map(|part| match part.trim().parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(number),
                _ => Err(format!("'{part}' is not a finite number")),
            })
            .collect();
        let numbers = numbers?;
        let count = numbers.len();
        numbers
            .try_into()
            .map(Self)
            .map_err(|_| format!("{N} numbers with commas between them are wanted, not {count}"))
    }
}

/// A place: latitude and longitude in degrees, altitude above the sea in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place(pub GlobalPosition);

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Numbers([latitude, longitude, altitude]) = text.parse()?;
        for (name, value, most) in [
            ("latitude", latitude, 89.0),
            ("longitude", longitude, 180.0),
            ("altitude", altitude, 9000.0),
        ] {
            if value.abs() > most {
                return Err(format!("{name} {value} is outside -{most} to {most}"));
            }
        }
        Ok(Self(GlobalPosition {
            latitude: (latitude * 1e7).round() as i32,
            longitude: (longitude * 1e7).round() as i32,
            altitude: (altitude * 1e3).round() as i32,
        }))
    }
}

/// Simulated seconds in one of the clock.
#[derive(Clone, Copy, Debug)]
pub struct Speed(pub f64);

impl FromStr for Speed {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim_end_matches(['x', '×']).parse::<f64>() {
            Ok(speed) if (0.1..=100.0).contains(&speed) => Ok(Self(speed)),
            Ok(speed) if !speed.is_nan() => Err(format!("{speed} is outside 0.1 to 100")),
            _ => Err(format!("'{text}' is not a number")),
        }
    }
}

/// A host and a port.
#[derive(Clone, Copy, Debug)]
pub struct Endpoint(pub SocketAddr);

impl FromStr for Endpoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let addresses = text
            .to_socket_addrs()
            .map_err(|e| format!("HOST:PORT is wanted: {e}"))?;
        let mut all: Vec<SocketAddr> = addresses.collect();
        all.sort_by_key(SocketAddr::is_ipv6);
        all.first()
            .copied()
            .map(Self)
            .ok_or_else(|| format!("'{text}' is no host that is known"))
    }
}

/// A port on this machine alone, or a host and a port; 0 is none.
#[derive(Clone, Copy, Debug)]
pub struct Listening(pub Option<SocketAddr>);

impl FromStr for Listening {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse::<u16>() {
            Ok(0) => Ok(Self(None)),
            Ok(port) => Ok(Self(Some(([127, 0, 0, 1], port).into()))),
            Err(_) => text.parse::<Endpoint>().map(|endpoint| Self(Some(endpoint.0))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_told_apart() {
        assert!("1,2".parse::<Numbers<2>>().is_ok());
        for wrong in ["1", "1,2,3", "1,nan", "1,inf", "a,b", ""] {
            assert!(wrong.parse::<Numbers<2>>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn percentages_are_0_to_100() {
        for (text, percent) in [("0", 0.0), ("15.5", 15.5), ("100%", 100.0)] {
            assert_eq!(text.parse::<Percent>().unwrap().0, percent);
        }
        for wrong in ["-1", "101", "1e9", "inf"] {
            let refusal = wrong.parse::<Percent>().unwrap_err();
            assert!(refusal.contains("outside 0 to 100"), "{refusal}");
        }
        for wrong in ["", "full", "nan"] {
            let refusal = wrong.parse::<Percent>().unwrap_err();
            assert!(refusal.contains("is not a number"), "{refusal}");
        }
    }

    #[test]
    fn settings_are_inside_their_ranges() {
        let setting: Setting = "NAV_RCL_ACT=3".parse().unwrap();
        assert_eq!((setting.name, setting.value), ("NAV_RCL_ACT", 3.0));
        for (wrong, words) in [
            ("NAV_RCL_ACT", "NAME=VALUE is wanted"),
            ("NAV_RCL_ACT=", "'' is not a number"),
            ("NAV_RCL_ACT=nan", "the range is 0 to 6"),
            ("NAV_RCL_ACT=7", "NAV_RCL_ACT: the range is 0 to 6"),
            ("SPEED=7", "there is no parameter SPEED; `windhover parameters`"),
        ] {
            let refusal = wrong.parse::<Setting>().unwrap_err();
            assert!(refusal.contains(words), "{refusal}");
        }
    }

    #[test]
    fn places_are_on_earth() {
        let Place(place) = "47.3977418,8.5455938,488".parse().unwrap();
        assert_eq!(
            (place.latitude, place.longitude, place.altitude),
            (473_977_418, 85_455_938, 488_000)
        );
        for (wrong, words) in [
            ("91,0,0", "latitude 91"),
            ("0,181,0", "longitude 181"),
            ("0,0,1e9", "altitude"),
            ("0,0", "3 numbers"),
            ("0,0,nan", "not a finite number"),
        ] {
            let refusal = wrong.parse::<Place>().unwrap_err();
            assert!(refusal.contains(words), "{refusal}");
        }
    }

    #[test]
    fn ports_are_on_the_loopback_unless_told_otherwise() {
        let listening = |text: &str| text.parse::<Listening>().unwrap().0.map(|a| a.to_string());
        assert_eq!(listening("5760"), Some("127.0.0.1:5760".into()));
        assert_eq!(listening("0.0.0.0:5760"), Some("0.0.0.0:5760".into()));
        assert_eq!(listening("0"), None);
        assert!("99999".parse::<Listening>().unwrap_err().contains("HOST:PORT"));
        assert!("127.0.0.1".parse::<Endpoint>().is_err());
        assert!("0".parse::<Speed>().is_err() && "nan".parse::<Speed>().is_err());
        assert_eq!("10x".parse::<Speed>().unwrap().0, 10.0);
    }
}
