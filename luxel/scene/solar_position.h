// Where the sun stands, by time and place. [Meeus98, chapters 7, 12, 13, 25]
#pragma once

namespace luxel::scene {

/// A moment of universal time in the Gregorian calendar.
struct UtcTime {
  int year = 2000, month = 1, day = 1;
  double hours = 12;  ///< since midnight; may be negative or more than 24
};

/// Days and their parts since noon of the first of January 4713 BC [Meeus98, eq. 7.1].
double julian_day(const UtcTime& time);

/// Where the sun stands in the sky.
struct SolarPosition {
  double azimuth_rad = 0;    ///< compass bearing: 0 north, pi/2 east
  double elevation_rad = 0;  ///< geometric: refraction, half a degree at the horizon, left out
  double distance_au = 1;
};

/// The sun seen from a latitude (north positive) and longitude (east positive). Within 0.01 degrees
/// from 1900 to 2100.
SolarPosition solar_position(double julian_day, double latitude_rad, double longitude_rad);

}  // namespace luxel::scene
