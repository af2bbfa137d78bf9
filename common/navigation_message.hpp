// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ephemeris.hpp"
#include "common/result.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace aeolis {

/// Trajectories and attitudes as CCSDS messages of keywords and values (KVN): the Orbit Ephemeris Message, versions 1
/// to 3 [ccsds-502.0-b-3], and the Attitude Ephemeris Message, versions 1 and 2 [ccsds-504.0-b-2].
///
/// Units    km, km/s, deg/s in the text                    Times    UTC, TAI, TT, TDB, GPS
/// Read     states; of attitudes quaternions, alone or with angular velocity. Comments, accelerations and covariances
///          are passed over
/// Faults   anything else is refused with its line: an unknown keyword or attitude type, a missing one, times that do
///          not ascend, a number that is none
struct MessageHeader {
    EphemerisTime created;
    std::string originator = "AEOLIS";
    std::string comment;  ///< one line; empty: none
};

/// Each segment of the message, in its order.
Result<std::vector<Ephemeris>> read_orbit_message(std::string_view text);
Result<std::vector<AttitudeHistory>> read_attitude_message(std::string_view text);

/// Version 2 of OEM, in UTC. No ephemeris is empty.
std::string orbit_message(const std::vector<Ephemeris>& segments, const MessageHeader& header);
/// Version 2 of AEM, in UTC: quaternions, with angular velocity in frame B where each state of a segment has it.
std::string attitude_message(const std::vector<AttitudeHistory>& segments, const MessageHeader& header);

}  // namespace aeolis
