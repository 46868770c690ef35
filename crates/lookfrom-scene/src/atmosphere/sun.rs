//! The position of the sun by place and time (Blanco-Muriel et al. 2001, "Computing the solar vector"): within half a minute of arc
//! until 2015, and some minutes in the decades around.

use std::f64::consts::{PI, TAU};

/// A place on earth, and a time there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlaceAndTime {
    /// Degrees to the north of the equator.
    pub(crate) latitude: f64,
    /// Degrees to the east of Greenwich.
    pub(crate) longitude: f64,
    /// Hours that the clock is ahead of universal time.
    pub(crate) timezone: f64,
    /// Year, month from 1, and day from 1, by the clock.
    pub(crate) date: [i32; 3],
    /// Hours since midnight, by the clock; with fractions.
    pub(crate) hours: f64,
}

/// Radius of the earth over its distance from the sun.
const PARALLAX: f64 = 6371.01 / 149_597_890.0;

impl PlaceAndTime {
    /// Elevation and azimuth of the sun in radians: above the horizon, and from north by east.
    pub(crate) fn sun(&self) -> [f64; 2] {
        let universal = self.hours - self.timezone;
        let days = days_since_2000(self.date) + universal / 24.0;

        // The place of the sun on the ecliptic.
        let node = 2.1429 - 0.001_039_459_4 * days;
        let mean_longitude = 4.895_063_0 + 0.017_202_791_698 * days;
        let anomaly = 6.240_060_0 + 0.017_201_969_9 * days;
        let longitude =
            mean_longitude + 0.033_416_07 * libm::sin(anomaly) + 0.000_348_94 * libm::sin(2.0 * anomaly)
                - 0.000_113_4
                - 0.000_020_3 * libm::sin(node);
        let obliquity = 0.409_092_8 - 6.2140e-9 * days + 0.000_039_6 * libm::cos(node);

        // Right ascension and declination, and the angle from the meridian of the place.
        let right_ascension =
            libm::atan2(libm::cos(obliquity) * libm::sin(longitude), libm::cos(longitude)).rem_euclid(TAU);
        let declination = libm::asin(libm::sin(obliquity) * libm::sin(longitude));
        let sidereal_hours = 6.697_424_324_2 + 0.065_709_828_3 * days + universal;
        let hour_angle = (15.0 * sidereal_hours + self.longitude).to_radians() - right_ascension;

        // Above the horizon, as seen from the surface of the earth.
        let latitude = self.latitude.to_radians();
        let cos_zenith = libm::cos(latitude) * libm::cos(hour_angle) * libm::cos(declination)
            + libm::sin(declination) * libm::sin(latitude);
        let zenith = libm::acos(cos_zenith.clamp(-1.0, 1.0));
        let azimuth = libm::atan2(
            -libm::sin(hour_angle),
            libm::tan(declination) * libm::cos(latitude) - libm::sin(latitude) * libm::cos(hour_angle),
        );
        [0.5 * PI - zenith - PARALLAX * libm::sin(zenith), azimuth]
    }
}

/// Whether a year, month and day are a date from 1900 to 2100, in which the sun's position is good.
pub(crate) fn is_date(date @ [year, month, day]: [i32; 3]) -> bool {
    let next = if month == 12 { [year + 1, 1, 1] } else { [year, month + 1, 1] };
    (1900..=2100).contains(&year)
        && (1..=12).contains(&month)
        && day >= 1
        && days_since_2000(date) < days_since_2000(next)
}

/// Days from noon of 1 January 2000 to midnight of a date of the Gregorian calendar (Fliegel & Van Flandern 1968).
fn days_since_2000([year, month, day]: [i32; 3]) -> f64 {
    let [year, month, day] = [year, month, day].map(i64::from);
    let before_march = (month - 14) / 12;
    let julian = (1461 * (year + 4800 + before_march)) / 4 + (367 * (month - 2 - 12 * before_march)) / 12
        - (3 * ((year + 4900 + before_march) / 100)) / 4
        + day
        - 32_075;
    (julian - 2_451_545) as f64 - 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions with x to the south, y to the west and z up, asked of Mitsuba 3.9.
    #[test]
    fn the_sun_is_where_mitsuba_has_it() {
        let tokyo = PlaceAndTime {
            latitude: 35.6894,
            longitude: 139.6917,
            timezone: 9.0,
            date: [2010, 7, 10],
            hours: 15.0,
        };
        let cases = [
            (tokyo, [0.051_385_4, 0.691_748, 0.720_308]),
            (PlaceAndTime { hours: 9.0, ..tokyo }, [0.095_695_2, -0.614_786, 0.782_867]),
            (
                PlaceAndTime {
                    latitude: -33.9,
                    longitude: 18.4,
                    timezone: 2.0,
                    date: [2024, 12, 21],
                    hours: 8.0 + 30.0 / 60.0 + 15.0 / 3600.0,
                },
                [0.102_467, -0.821_714, 0.560_613],
            ),
            (
                PlaceAndTime {
                    latitude: 70.0,
                    longitude: 20.0,
                    timezone: 1.0,
                    date: [2030, 6, 21],
                    hours: 23.5,
                },
                [-0.997_039, 0.047_792_9, 0.060_237_8],
            ),
        ];
        for (place, expected) in cases {
            let [elevation, azimuth] = place.sun();
            let across = libm::cos(elevation);
            let found = [-across * libm::cos(azimuth), -across * libm::sin(azimuth), libm::sin(elevation)];
            for k in 0..3 {
                assert!((found[k] - expected[k]).abs() < 1e-4, "{place:?}: {found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn dates_have_the_days_of_their_months() {
        assert!([[2024, 2, 29], [2026, 12, 31], [1900, 1, 1]].into_iter().all(is_date));
        let others = [
            [2026, 2, 29],
            [2026, 4, 31],
            [2026, 13, 1],
            [2026, 0, 1],
            [2026, 1, 0],
            [1899, 1, 1],
            [2026, 1, i32::MAX],
        ];
        assert!(!others.into_iter().any(is_date));
    }

    #[test]
    fn days_are_counted_over_leap_years() {
        assert_eq!(days_since_2000([2000, 1, 1]), -0.5);
        assert_eq!(days_since_2000([2000, 3, 1]), 59.5);
        assert_eq!(days_since_2000([2001, 1, 1]), 365.5);
        assert_eq!(days_since_2000([1999, 12, 31]), -1.5);
    }
}
