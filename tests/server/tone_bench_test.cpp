// SPDX-License-Identifier: Apache-2.0
#include "server/tones/tone_bench.hpp"
#include "simulation/links/tone_detection.hpp"
#include "simulation/links/x_band_link.hpp"
#include "simulation/links/x_band_receiver_model.hpp"
#include "telemetry/mfsk/symbol_error.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <cmath>

namespace server_tone_bench_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("the statistical model splits power as the waveform of the dictionary does", "[tones]") {
    const MfskWaveform& mfsk = tests::shipped_dictionary().mfsk;
    CHECK(simulation::XBandLink::carrier_power_db() == Approx(10.0 * std::log10(mfsk.carrier_fraction())));
    CHECK(simulation::XBandLink::tone_power_db() == Approx(10.0 * std::log10(mfsk.tone_fraction())));
}

TEST_CASE("the statistical model's curve is that of the real receiver's correlator on samples, and both are theory's",
          "[tones][R31]") {
    const MfskWaveform& mfsk = tests::shipped_dictionary().mfsk;
    simulation::Random random{3, 0, simulation::Stream::x_band};
    for (const double theory : {0.3, 0.1}) {
        const double tone_dbhz = 10.0 * std::log10(telemetry::energy_for_symbol_error(theory, 256) / mfsk.symbol_s);
        ErrorCount statistical;
        for (; statistical.trials < 2000; ++statistical.trials)
            if (simulation::detect_tone(77, tone_dbhz, mfsk.symbol_s, random).best[0].tone != 77) ++statistical.errors;
        const ErrorCount real = baseband_errors(mfsk, {tone_dbhz}, 1000, 9);
        const auto deviation = [&](const ErrorCount& count) {
            return std::sqrt(theory * (1.0 - theory) / static_cast<double>(count.trials));
        };
        CHECK(real.rate() == Approx(theory).margin(3.5 * deviation(real)));
        CHECK(statistical.rate() == Approx(theory).margin(3.5 * deviation(statistical)));
    }
}

TEST_CASE(
    "where the statistical model hears tones the whole receiver hears them as well, and below that it is the model "
    "that is deaf",
    "[tones][R31]") {
    const MfskWaveform& mfsk = tests::shipped_dictionary().mfsk;
    constexpr std::uint64_t symbols = 60;
    const auto drawn_errors = [&](double total_c_n0_dbhz) {
        simulation::XBandReceiverModel receiver{total_c_n0_dbhz, {}, 5, 0};
        telemetry::Downlink heard;
        constexpr std::int64_t symbol_ticks = 640;
        for (std::int64_t tick = 0; tick <= symbol_ticks * static_cast<std::int64_t>(symbols); ++tick) {
            simulation::XBandField field;
            field.e_s = static_cast<double>(tick) * seconds_per_tick;
            field.ert = Ert{tick * 15625};
            field.up = true;
            field.tone = ToneId{42};
            field.tone_age_s = static_cast<double>(tick % symbol_ticks) * seconds_per_tick;
            receiver.hear(field, heard);
        }
        const auto right = std::ranges::count(heard.tones, std::optional{ToneId{42}}, &telemetry::ReceivedTone::tone);
        return symbols - static_cast<std::uint64_t>(right);
    };
    const double least_heard_dbhz = 15.8 - simulation::XBandLink::carrier_power_db();  // what a search over 4 s needs
    CHECK(drawn_errors(least_heard_dbhz + 0.05) == 0);
    CHECK(receiver_errors(mfsk, least_heard_dbhz + 0.05, symbols, 11).errors == 0);
    CHECK(drawn_errors(least_heard_dbhz - 0.05) == symbols);
    CHECK(receiver_errors(mfsk, least_heard_dbhz - 2.0, symbols, 12).errors < symbols / 20);  // once it has the carrier
}

TEST_CASE("a counted rate's interval holds the rate, and an error rate tells its loss", "[tones]") {
    const RateInterval interval = interval_of({10, 1000});
    CHECK(interval.low == Approx(0.00544).margin(1e-4));
    CHECK(interval.high == Approx(0.01831).margin(1e-4));
    CHECK(interval_of({}).high == 1.0);
    CHECK(loss_db(2.36, 10.0, 0.01) == Approx(0.0).margin(0.005));
    CHECK(loss_db(3.36, 10.0, 0.01) == Approx(1.0).margin(0.005));
}

}  // namespace server_tone_bench_test
