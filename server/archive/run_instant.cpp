// SPDX-License-Identifier: Apache-2.0
#include "server/archive/run_instant.hpp"

#include "server/archive/items.hpp"

#include <charconv>
#include <cmath>

namespace aeolis::archive {
namespace {

constexpr double scet_text_s = 1.0e-3;  // day-of-year texts are truncated to it: converts to the tick within it

/// Chosen: 200 years of SCLK and of light, beyond which a microsecond count may overflow.
constexpr double clock_s_max = 6.4e9;

std::optional<double> number_of(std::string_view text) {
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
    return number;
}

/// A plus that was not percent-encoded is a blank: in "E 4:58" and in "2012-08-06T05:00:00 02:00".
std::string with_plus(std::string_view text) {
    std::string written{text};
    constexpr std::size_t offset = std::string_view{"+02:00"}.size();
    if (written.starts_with("E ")) written[1] = '+';
    if (written.size() > offset && written[written.size() - offset] == ' ') written[written.size() - offset] = '+';
    return written;
}

/// An instant as it is written: by a clock on board, or UTC at the vehicle or on Earth.
struct WrittenInstant {
    std::optional<Sclk> sclk{};
    Scet utc{};
    enum class By : std::uint8_t { unsaid, scet, ert } by = By::unsaid;  ///< the utc
};

Error no_instant(std::string_view name, std::string_view text) {
    return Error{std::string{name} + ": '" + std::string{text} +
                 "' is no instant: seconds of SCLK, SCET as 2012-219T05:00:00 or 2012-08-06T05:00:00Z, "
                 "ert:2012-219T05:13:48, or E+4:58"};
}

Result<WrittenInstant> read_instant(std::string_view text, Sclk entry, std::string_view name) {
    const auto written = with_plus(text);
    if (const auto entry_s = seconds_from_entry(written)) {
        if (entry == Sclk{})
            return Error{std::string{name} + ": '" + std::string{text} +
                         "' counts from entry, and nobody knows when the run has it: a time of a clock is wanted"};
        return WrittenInstant{entry + *entry_s};
    }
    using By = WrittenInstant::By;
    const auto by = written.starts_with(ert_prefix)    ? By::ert
                    : written.starts_with(scet_prefix) ? By::scet
                                                       : By::unsaid;
    const auto prefix = by == By::ert ? ert_prefix.size() : by == By::scet ? scet_prefix.size() : 0;
    if (const auto utc = scet_from_text(std::string_view{written}.substr(prefix)))
        return WrittenInstant{.utc = *utc, .by = by};
    if (const auto sclk_s = number_of(text)) return WrittenInstant{Sclk{*sclk_s}};
    return no_instant(name, text);
}

std::int64_t light_us(double light_time_s) {
    return static_cast<std::int64_t>(light_time_s * 1.0e6);
}

}  // namespace

Result<Sclk> instant_of(std::string_view text, const v1::RunState& run, std::string_view name) {
    const auto read = read_instant(text, Sclk{run.entry_sclk()}, name);
    if (!read) return read.error();
    if (read->sclk) return *read->sclk;
    const auto clock = correlation_of(run);
    if (clock.scet == Scet{})
        return Error{std::string{name} + ": nobody knows which SCET run " + std::to_string(run.run()) +
                     " has: seconds of SCLK are wanted"};
    const auto back_us = read->by == WrittenInstant::By::ert ? light_us(run.light_time_s()) : 0;
    const Sclk exact = clock.sclk_of(Scet{read->utc.microseconds - back_us}),
               tick = Sclk::from_ticks(std::llround(exact.seconds / seconds_per_tick));
    return std::abs(tick - exact) < scet_text_s ? tick : exact;
}

Result<void> check_instant(std::string_view text, std::string_view name) {
    constexpr Sclk some_entry{1.0};
    const auto read = read_instant(text, some_entry, name);
    if (!read) return read.error();
    if (read->sclk && std::abs(read->sclk->seconds) > clock_s_max) return no_instant(name, text);
    return {};
}

namespace {

/// The station's time of an instant: a UTC time alone, or after "ert:", is the station's own; one of the vehicle is
/// `light_times` away from it.
Result<Ert> at_station(std::string_view text, const RunClocks& clocks, std::string_view name, int light_times) {
    const auto read = read_instant(text, clocks.entry, name);
    if (!read) return read.error();
    if (!read->sclk && read->by != WrittenInstant::By::scet) return Ert{read->utc.microseconds};
    auto at_vehicle = read->utc;
    if (read->sclk) {
        if (std::abs(*read->sclk - clocks.correlation.sclk) > clock_s_max) return no_instant(name, text);
        if (clocks.correlation.scet == Scet{})
            return Error{std::string{name} + ": nobody knows which SCET the run has: a UTC time is wanted"};
        at_vehicle = clocks.correlation.scet_of(*read->sclk);
    }
    return Ert{at_vehicle.microseconds + light_times * light_us(clocks.light_time_s)};
}

}  // namespace

Result<Ert> departure_of(std::string_view text, const RunClocks& clocks, std::string_view name) {
    return at_station(text, clocks, name, -1);
}

Result<Ert> reception_of(std::string_view text, const RunClocks& clocks, std::string_view name) {
    return at_station(text, clocks, name, 1);
}

RunClocks clocks_of(const v1::RunState& run) {
    return {correlation_of(run), Sclk{run.entry_sclk()}, run.light_time_s()};
}

}  // namespace aeolis::archive
