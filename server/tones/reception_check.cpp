// SPDX-License-Identifier: Apache-2.0
#include "server/tones/reception_check.hpp"

#include "telemetry/mfsk/doppler_slope.hpp"

#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <tuple>

namespace aeolis::server {
namespace {

constexpr double doppler_most_hz = 500e3;       // chosen
constexpr double clock_error_most_ppm = 600.0;  // that the receiver finds

std::string frequencies(const std::vector<double>& lines_hz) {
    std::string text;
    for (const double hz : lines_hz) text += fmt::format("{}{:.1f}", text.empty() ? "" : ",", hz);
    return text;
}

}  // namespace

std::vector<ReceptionRemark> check_reception(const HeardRecording& heard, const SampleClaims& claims) {
    std::vector<ReceptionRemark> remarks;
    const auto tell = [&](bool fault, std::string text) { remarks.push_back({std::move(text), fault}); };
    const telemetry::ReceiverStatus& status = heard.status;
    if (claims.frequency_hz &&
        std::abs(*claims.frequency_hz - claims.carrier_hz) > 0.5 * claims.rate_hz + doppler_most_hz)
        tell(true, fmt::format("the middle of the band is {} Hz, and tones are sent at {} Hz", *claims.frequency_hz,
                               claims.carrier_hz));
    if (status.loudest == 0.0) {
        tell(true, fmt::format("silence, {:.1f} s of it", heard.length_s));
        return remarks;
    }
    if (status.gap_s > 0.0) tell(false, fmt::format("{:.1f} s without usable samples", status.gap_s));
    if (status.clock_error_ppm && std::abs(*status.clock_error_ppm) > 30.0)
        tell(false, fmt::format("the samples' clock runs {} by {:.0f} ppm, which was corrected",
                                *status.clock_error_ppm > 0.0 ? "fast" : "slow", std::abs(*status.clock_error_ppm)));
    if (status.contradicted > 0)
        tell(true, fmt::format("{} tones erased, as most lie between the tones' frequencies: the rate is wrong",
                               status.contradicted));
    if (!status.left_out_hz.empty())
        tell(false, fmt::format("lines that stand still beside the carrier were left out, at {} Hz",
                                frequencies(status.left_out_hz)));
    for (const auto& [table, name, is_expected] :
         {std::tuple{&claims.predict_hz, "--predict", false}, std::tuple{&claims.expected_hz, "--expected", true}}) {
        const auto slope = table->empty() ? std::nullopt : telemetry::doppler_slope(heard.carrier, *table);
        if (!slope) continue;
        if (std::abs(*slope - 1.0) < 0.3 && !is_expected)
            tell(true, "the Doppler of --predict is still in the samples; give it by --expected");
        if (std::abs(*slope + 1.0) < 0.3)
            tell(true, is_expected
                           ? "the Doppler of --expected is no longer in the samples; give it by --predict"
                           : "in-phase and quadrature are exchanged, and the Doppler of --predict is in the samples");
        if (std::abs(*slope + 2.0) < 0.3)
            tell(true, fmt::format("the carrier moves against {}: in-phase and quadrature are exchanged", name));
    }
    if (status.carrier_s == 0.0)
        tell(true, fmt::format("no carrier was heard within {:.1f} s; rate {} Hz, format {}", heard.length_s,
                               claims.rate_hz, claims.format));
    else if (heard.tones == 0 && heard.length_s > claims.symbol_s)
        tell(true,
             fmt::format("a carrier for {:.1f} s, and no tone on it{}; is {} Hz its rate, to {:.0f} ppm?{}",
                         status.carrier_s, heard.erasures > 0 ? fmt::format(", {} erased", heard.erasures) : "",
                         claims.rate_hz, clock_error_most_ppm,
                         status.standing_hz.empty()
                             ? ""
                             : fmt::format(" What stands still may be a line that hides the carrier: --exclude {}",
                                           frequencies(status.standing_hz))));
    else if (heard.left_over_octets > 0)
        tell(true, fmt::format("{} octets behind the last whole sample: truncated, or not {}", heard.left_over_octets,
                               claims.format));
    return remarks;
}

}  // namespace aeolis::server
