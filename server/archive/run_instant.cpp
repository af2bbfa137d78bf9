// SPDX-License-Identifier: Apache-2.0
#include "server/archive/run_instant.hpp"

#include "server/archive/items.hpp"

#include <charconv>
#include <cmath>

namespace aeolis::archive {
namespace {

constexpr double scet_text_s = 1.0e-3;  // day-of-year texts are truncated to it: converts to the tick within it

std::optional<double> number_of(std::string_view text) {
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
    return number;
}

}  // namespace

Result<Sclk> instant_of(std::string_view text, const v1::RunState& run, std::string_view name) {
    std::string written{text};
    if (written.starts_with("E ")) written[1] = '+';  // a plus that was not percent-encoded is a blank
    if (const auto entry_s = seconds_from_entry(written)) return Sclk{run.entry_sclk()} + *entry_s;
    const bool is_ert = text.starts_with(ert_prefix);
    const auto utc = scet_from_text(text.substr(is_ert ? ert_prefix.size() : 0));
    if (!utc) {
        const auto sclk_s = number_of(text);
        if (sclk_s) return Sclk{*sclk_s};
        return Error{std::string{name} + ": '" + std::string{text} +
                     "' is no instant: seconds of SCLK, SCET as 2012-219T05:00:00 or 2012-08-06T05:00:00Z, "
                     "ert:2012-219T05:13:48, or E+4:58"};
    }
    const auto clock = correlation_of(run);
    if (clock.scet == Scet{})
        return Error{std::string{name} + ": nobody knows which SCET run " + std::to_string(run.run()) +
                     " has: seconds of SCLK are wanted"};
    const auto light_us = is_ert ? static_cast<std::int64_t>(run.light_time_s() * 1.0e6) : 0;
    const Sclk exact = clock.sclk_of(Scet{utc->microseconds - light_us}),
               tick = Sclk::from_ticks(std::llround(exact.seconds / seconds_per_tick));
    return std::abs(tick - exact) < scet_text_s ? tick : exact;
}

}  // namespace aeolis::archive
