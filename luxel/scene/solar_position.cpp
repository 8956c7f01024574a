#include "luxel/scene/solar_position.h"

#include <algorithm>
#include <cmath>

#include "luxel/base/vec_double.h"

namespace luxel::scene {
namespace {

constexpr double kDegree = kPiDouble / 180;

/// The apparent sun among the stars [Meeus98, chapter 25], low accuracy: 0.01 degrees.
struct Apparent {
  double right_ascension_rad = 0, declination_rad = 0;
  double distance_au = 1;
  double nutation_of_time_deg = 0;  ///< of sidereal time
};

Apparent apparent_sun(double t) {
  const double mean_longitude = 280.46646 + 36000.76983 * t + 0.0003032 * t * t;
  const double anomaly = (357.52911 + 35999.05029 * t - 0.0001537 * t * t) * kDegree;
  const double eccentricity = 0.016708634 - 0.000042037 * t - 0.0000001267 * t * t;
  const double centre = (1.914602 - 0.004817 * t - 0.000014 * t * t) * std::sin(anomaly) +
                        (0.019993 - 0.000101 * t) * std::sin(2 * anomaly) +
                        0.000289 * std::sin(3 * anomaly);
  const double true_anomaly = anomaly + centre * kDegree;
  const double node = (125.04 - 1934.136 * t) * kDegree;
  const double nutation_deg = -0.00478 * std::sin(node);
  const double longitude = (mean_longitude + centre - 0.00569 + nutation_deg) * kDegree;
  const double obliquity = (23.4392911 - 0.0130042 * t + 0.00256 * std::cos(node)) * kDegree;
  Apparent out;
  out.right_ascension_rad =
      std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
  out.declination_rad = std::asin(std::sin(obliquity) * std::sin(longitude));
  out.distance_au =
      1.000001018 * (1 - eccentricity * eccentricity) / (1 + eccentricity * std::cos(true_anomaly));
  out.nutation_of_time_deg = nutation_deg * std::cos(obliquity);
  return out;
}

}  // namespace

double julian_day(const UtcTime& time) {
  // January and February count as months 13 and 14 of the year before.
  const int year = time.month > 2 ? time.year : time.year - 1;
  const int month = time.month > 2 ? time.month : time.month + 12;
  const double century = std::floor(year / 100.0);
  const double gregorian = 2 - century + std::floor(century / 4);
  return std::floor(365.25 * (year + 4716)) + std::floor(30.6001 * (month + 1)) + time.day +
         gregorian - 1524.5 + time.hours / 24;
}

SolarPosition solar_position(double julian_day, double latitude_rad, double longitude_rad) {
  const double days = julian_day - 2451545.0, t = days / 36525;
  const Apparent sun = apparent_sun(t);
  const double sidereal_deg = 280.46061837 + 360.98564736629 * days + 0.000387933 * t * t -
                              t * t * t / 38710000 + sun.nutation_of_time_deg;
  const double hour_angle =
      std::fmod(sidereal_deg, 360) * kDegree + longitude_rad - sun.right_ascension_rad;
  const double sin_lat = std::sin(latitude_rad), cos_lat = std::cos(latitude_rad);
  const double sin_dec = std::sin(sun.declination_rad), cos_dec = std::cos(sun.declination_rad);
  // East, north and up of the direction towards the sun.
  const double east = -cos_dec * std::sin(hour_angle);
  const double north = sin_dec * cos_lat - cos_dec * std::cos(hour_angle) * sin_lat;
  const double up = sin_dec * sin_lat + cos_dec * std::cos(hour_angle) * cos_lat;
  const double azimuth = std::atan2(east, north);
  return {azimuth < 0 ? azimuth + 2 * kPiDouble : azimuth, std::asin(std::clamp(up, -1.0, 1.0)),
          sun.distance_au};
}

}  // namespace luxel::scene
