// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/xtce/packet_model.hpp"
#include "telemetry/container_decoder.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::telemetry {

/// Where a packet's time is, as "NAME" or "NAME:FORM". A user gives it for a mission whose XTCE file does not.
///
/// NAME     a parameter by name or path, also with a member: "TIME", "/M/TIME", "HEADER.time"
/// FORM     seconds, milliseconds, microseconds: of a number. cuc: counts and their binary fraction, of a parameter
///          with two whole numbers, or of four to seven octets, of which the first four are counts. cds: days,
///          milliseconds of the day and, where there are more, microseconds or picoseconds of the millisecond, of two
///          or three numbers, or of 6, 8 or 10 octets with 16 bits of days. cuc-preamble, cds-preamble: octets that
///          begin with the preamble (P-field), which says their sizes. [ccsds-301.0-b-4] Without FORM: seconds for a
///          number, cuc for two whole numbers. For octets FORM is needed, because the values of a clock may look like a
///          preamble
///          Days of CDS are of UTC, of 86 400 s and with a leap second 86 401: more milliseconds are no time
/// Epoch    that of the parameter's type; TAI where a preamble says so; else none is known
struct TimeSource {
    enum class Form : std::uint8_t {
        as_fits,
        seconds,
        milliseconds,
        microseconds,
        cuc,
        cuc_preamble,
        cds,
        cds_preamble
    };

    std::size_t parameter = 0;
    std::string name;    ///< of the parameter, as values are named
    std::string member;  ///< ".time"; empty: the parameter itself
    std::string epoch;   ///< of its type
    Form form = Form::as_fits;

    /// The Error names the fault and the possible parameters.
    static Result<TimeSource> parse(const dictionary::xtce::PacketModel& model, const std::string& text);

    /// The time among a packet's values; none: the packet does not hold it, or it is undefined.
    std::optional<PacketTime> time_in(std::span<const DecodedValue> values) const;
    /// Whether the parameter is among the values and defined. Where time_in() then gives none, it is not in this form.
    bool is_defined_in(std::span<const DecodedValue> values) const;

  private:
    /// The parameter itself, or its members and elements, in the order of the packet.
    std::vector<const DecodedValue*> parts_in(std::span<const DecodedValue> values) const;
};

}  // namespace aeolis::telemetry
