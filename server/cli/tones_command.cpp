// SPDX-License-Identifier: Apache-2.0
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/rehearsal/predicted_doppler.hpp"
#include "server/tones/doppler_file.hpp"
#include "server/tones/flown_signal.hpp"
#include "server/tones/sample_file.hpp"
#include "server/tones/tone_bench.hpp"
#include "simulation/links/x_band_channel.hpp"
#include "telemetry/mfsk/tone_receiver.hpp"

#include <cmath>
#include <fmt/format.h>
#include <memory>

namespace aeolis::server {
namespace {

struct TonesDecodeOptions {
    SharedOptions shared;
    std::filesystem::path samples;
    double rate_hz = 0.0;
    std::string format;
    std::optional<std::filesystem::path> predict;  ///< Doppler removed before sampling
    double start_s = 0.0;                          ///< of the first sample, on the predict's time axis
    bool json = false;
};

struct TonesSimulateOptions {
    SharedOptions shared;
    std::filesystem::path out;
    double rate_hz = 16384.0;
    std::string format = "cf32";
    std::optional<std::string> scenario;  ///< the tones and Doppler of a landing, from entry interface
    std::optional<std::filesystem::path> tones, doppler, predict;
    std::optional<std::filesystem::path> predict_out;  ///< ground's predict, written here instead
    std::optional<double> from_s, length_s;
    double c_n0_dbhz = 22.0;
    std::uint64_t seed = 1, case_number = 0;
};

struct TonesBenchOptions {
    SharedOptions shared;
    bool full = false;
};

constexpr std::size_t block_samples = 65536;

Result<TimeTable> optional_doppler(const std::optional<std::filesystem::path>& file) {
    return file ? read_doppler(*file) : Result<TimeTable>{TimeTable{}};
}

/// Prints a symbol on one line, as JSON or in words.
void print(const telemetry::ToneReception& heard, const dictionary::Dictionary& dictionary, bool json) {
    if (!json) {
        const std::string name = heard.tone ? dictionary.tones[*heard.tone].name : std::string{};
        fmt::print("{:12.3f} s  {:>7}  {:.4f}  {:5.1f} dB-Hz  {:10.1f} Hz  {:<11} {}\n", heard.start_s,
                   heard.tone ? fmt::format("tone {}", *heard.tone) : "erasure", heard.evidence.best[0].likelihood,
                   heard.total_c_n0_dbhz, heard.doppler_hz, to_text(heard.lock), name);
        return;
    }
    std::string best, spectrum;
    for (const auto& each : heard.evidence.best)
        best +=
            fmt::format("{}{{\"tone\":{},\"likelihood\":{:.6g}}}", best.empty() ? "" : ",", each.tone, each.likelihood);
    for (const std::uint8_t level : heard.evidence.spectrum)
        spectrum += fmt::format("{}{:.1f}", spectrum.empty() ? "" : ",", spectrum_db(level));
    fmt::print("{{\"start_s\":{:.3f},\"tone\":{},\"c_n0_dbhz\":{:.2f},\"doppler_hz\":{:.2f},\"lock\":\"{}\","
               "\"seen_fraction\":{:.3f},\"log_likelihood_ratio\":{:.2f},\"best\":[{}],\"spectrum_db\":[{}]}}\n",
               heard.start_s, heard.tone ? std::to_string(*heard.tone) : "null", heard.total_c_n0_dbhz,
               heard.doppler_hz, to_text(heard.lock), heard.seen_fraction, heard.evidence.log_likelihood_ratio, best,
               spectrum);
}

struct Sending {
    std::vector<simulation::SentTone> tones;
    simulation::XBandPath path;
    double length_s = 0.0;
    TimeTable expected_hz;  ///< ground's predict of the Doppler
};

Result<Sending> sending_of_flight(const TonesSimulateOptions& options, const dictionary::Dictionary& dictionary) {
    const auto inputs = flight_inputs(options.shared, *options.scenario);
    if (!inputs) return inputs.error();
    const FlownSignal flown = fly_signal(inputs->scenario, options.seed, options.case_number, dictionary);
    if (flown.doppler_hz.empty()) return Error{"the landing did not come within 900 s of entry"};
    Sending sending;
    sending.tones = flown.tones;
    sending.path.doppler_hz = flown.doppler_hz;
    sending.path.gain_db = flown.gain_db;
    sending.path.start_s = options.from_s.value_or(flown.doppler_hz.first_s());
    sending.path.set_s = flown.earth_set_s;
    sending.expected_hz = predicted_doppler_hz(inputs->scenario, dictionary.mfsk);
    sending.length_s = options.length_s.value_or(flown.earth_set_s + 20.0 - sending.path.start_s);
    return sending;
}

Result<Sending> sending_of_files(const TonesSimulateOptions& options, const dictionary::Dictionary& dictionary) {
    Sending sending;
    if (options.tones) {
        auto tones = read_tones_to_send(*options.tones, dictionary.mfsk.symbol_s);
        if (!tones) return tones.error();
        sending.tones = std::move(*tones);
    }
    auto doppler = optional_doppler(options.doppler);
    if (!doppler) return doppler.error();
    sending.path.doppler_hz = sending.expected_hz = std::move(*doppler);
    const bool has_doppler = !sending.path.doppler_hz.empty();
    sending.path.start_s = options.from_s.value_or(has_doppler ? sending.path.doppler_hz.first_s() : 0.0);
    const double last_s = std::max(sending.tones.empty() ? 0.0 : sending.tones.back().start_s + 20.0,
                                   has_doppler ? sending.path.doppler_hz.last_s() : 0.0);
    sending.length_s = options.length_s.value_or(last_s - sending.path.start_s);
    return sending;
}

/// Prints one line per symbol. Returns 1 for silence, no carrier, or a long carrier without symbols.
int tones_decode(const TonesDecodeOptions& options) {
    const auto dictionary = loaded_dictionary(options.shared.dictionary);
    if (!dictionary) return 1;
    const auto format = sample_format(options.format);
    if (!format) return failed(format.error().message, 2);
    const auto predict = optional_doppler(options.predict);
    if (!predict) return failed(predict.error().message);
    auto receiver = telemetry::ToneReceiver::make(dictionary->mfsk, options.rate_hz, *predict, options.start_s);
    if (!receiver) return failed(receiver.error().message, 2);
    auto reader = SampleReader::open(options.samples, *format);
    if (!reader) return failed(reader.error().message);

    std::size_t symbols = 0;
    const auto print_new = [&] {
        for (const auto& heard : receiver->take()) {
            print(heard, *dictionary, options.json);
            ++symbols;
        }
    };
    std::vector<std::complex<float>> room(block_samples);
    for (;;) {
        const auto block = reader->next(room);
        if (!block) return failed(block.error().message);
        if (block->empty()) break;
        receiver->push(*block);
        print_new();
    }
    receiver->finish();
    print_new();
    const telemetry::ReceiverStatus& status = receiver->status();
    const double length_s = static_cast<double>(reader->samples()) / options.rate_hz;
    if (status.loudest == 0.0)
        return failed(fmt::format("{}: silence, {:.1f} s of it", options.samples.string(), length_s));
    if (status.carrier_s == 0.0)
        return failed(fmt::format("{}: no carrier within {:.1f} s; rate {} Hz, format {}", options.samples.string(),
                                  length_s, options.rate_hz, options.format));
    if (symbols == 0 && length_s > dictionary->mfsk.symbol_s)
        return failed(fmt::format("{}: a carrier for {:.1f} s, and no tone on it; is {} Hz its rate?",
                                  options.samples.string(), status.carrier_s, options.rate_hz));
    if (reader->left_over_octets() > 0)
        return failed(fmt::format("{}: {} octets behind the last whole sample: truncated, or not {}",
                                  options.samples.string(), reader->left_over_octets(), options.format));
    return 0;
}

/// Writes a file of simulated samples.
int tones_simulate(const TonesSimulateOptions& options) {
    const auto dictionary = options.scenario ? dictionary_of_flight(options.shared.dictionary)
                                             : Result<dictionary::Dictionary>{dictionary::Dictionary{}};
    if (!dictionary) return failed(dictionary.error().message);
    const auto words = options.scenario ? std::optional{*dictionary} : loaded_dictionary(options.shared.dictionary);
    if (!words) return 1;
    const auto format = sample_format(options.format);
    if (!format) return failed(format.error().message, 2);
    if (const auto possible = telemetry::ToneReceiver::make(words->mfsk, options.rate_hz); !possible)
        return failed(possible.error().message, 2);
    auto sending = options.scenario ? sending_of_flight(options, *words) : sending_of_files(options, *words);
    if (!sending) return failed(sending.error().message);
    if (!(sending->length_s > 0.0))
        return failed("there is nothing to send: give tones, Doppler, a scenario or --length", 2);
    const double start_s = sending->path.start_s;
    auto predict = options.predict_out
                       ? write_doppler(*options.predict_out, sending->expected_hz, start_s, start_s + sending->length_s)
                       : optional_doppler(options.predict);
    if (!predict) return failed(predict.error().message);
    const double residual_hz = sending->path.doppler_hz.at(start_s) - predict->at(start_s);
    if (std::abs(residual_hz) > 0.5 * options.rate_hz)
        return failed(
            fmt::format(
                "Doppler minus predict is {:.0f} Hz: outside of samples at {} Hz; give --predict or --predict-out",
                residual_hz, options.rate_hz),
            2);
    sending->path.predict_hz = std::move(*predict);
    sending->path.rate_hz = options.rate_hz;
    sending->path.total_c_n0_dbhz = options.c_n0_dbhz;

    auto writer = SampleWriter::open(options.out, *format);
    if (!writer) return failed(writer.error().message);
    simulation::XBandChannel channel{words->mfsk, sending->path, sending->tones, options.seed, options.case_number};
    std::vector<std::complex<float>> block(block_samples);
    auto left = static_cast<std::uint64_t>(sending->length_s * options.rate_hz);
    while (left > 0) {
        const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left, block.size()));
        channel.next(std::span{block}.first(count));
        if (const auto written = writer->add(std::span{block}.first(count)); !written)
            return failed(written.error().message);
        left -= count;
    }
    if (const auto closed = writer->close(); !closed) return failed(closed.error().message);
    fmt::print("{}: {:.1f} s from {:.3f} s on, {} tones, {} at {} Hz, {} dB-Hz total\n", options.out.string(),
               sending->length_s, sending->path.start_s, sending->tones.size(), options.format, options.rate_hz,
               options.c_n0_dbhz);
    return 0;
}

/// Prints the receiver's figures with their goals; returns 1 when one is missed.
int tones_bench(const TonesBenchOptions& options) {
    const auto landing = flight_inputs(options.shared, "od137");
    if (!landing) return failed(landing.error().message);
    simulation::Scenario dispersed = landing->scenario;
    const auto errors = scenario_given("nominal_auto", options.shared.scenarios);
    if (!errors) return failed(errors.error().message);
    dispersed.dispersions = errors->dispersions;
    const bool met = tell_tone_figures(landing->dictionary, landing->scenario, dispersed, options.full,
                                       [](const ToneFigure& figure) {
                                           fmt::print("{}\n", figure.text());
                                           std::fflush(stdout);
                                       });
    return met ? 0 : 1;
}

void add_tones_decode(CLI::App& tones, int& exit_code) {
    const auto options = std::make_shared<TonesDecodeOptions>();
    auto& command = *tones.add_subcommand("decode", "prints the tones in a file of complex samples, a line a symbol");
    command.add_option("--samples", options->samples, "the file: in-phase and quadrature, little-endian")->required();
    command.add_option("--rate", options->rate_hz, "samples a second")->required();
    command.add_option("--format", options->format, "cf32 or ci16")->required();
    command.add_option("--predict", options->predict, "CSV of the Doppler that was removed: time, doppler_hz");
    command.add_option("--start", options->start_s, "time of the first sample [s]")->capture_default_str();
    command.add_flag("--json", options->json, "a JSON object a line");
    add_shared(command, options->shared);
    command.callback([options, &exit_code] { exit_code = tones_decode(*options); });
}

void add_tones_simulate(CLI::App& tones, int& exit_code) {
    const auto options = std::make_shared<TonesSimulateOptions>();
    auto& command = *tones.add_subcommand("simulate", "writes a file of samples, from lists or from a landing");
    command.add_option("--out", options->out, "file to write")->required();
    command.add_option("--rate", options->rate_hz, "samples a second")->capture_default_str();
    command.add_option("--format", options->format, "cf32 or ci16")->capture_default_str();
    auto* list = command.add_option("--tones", options->tones, "CSV: start_s,tone");
    auto* doppler = command.add_option("--doppler", options->doppler, "CSV of the Doppler: time, doppler_hz");
    auto* scenario = command.add_option("--scenario", options->scenario, "tones and Doppler of this landing instead");
    list->excludes(scenario);
    doppler->excludes(scenario);
    auto* predict = command.add_option("--predict", options->predict, "CSV of the Doppler to remove: time, doppler_hz");
    command
        .add_option("--predict-out", options->predict_out, "compute the ground's predict, remove it, and write it here")
        ->excludes(predict);
    command.add_option("--from", options->from_s, "time of the first sample [s]");
    command.add_option("--length", options->length_s, "length [s]");
    command.add_option("--c-n0", options->c_n0_dbhz, "total power to noise density [dB-Hz]")->capture_default_str();
    command.add_option("--seed", options->seed, "seed of the noise and of the landing")
        ->check(whole_number())
        ->capture_default_str();
    command.add_option("--case", options->case_number, "number of the draw of the landing's errors")
        ->check(whole_number())
        ->capture_default_str();
    add_shared(command, options->shared);
    command.callback([options, &exit_code] { exit_code = tones_simulate(*options); });
}

void add_tones_bench(CLI::App& tones, int& exit_code) {
    const auto options = std::make_shared<TonesBenchOptions>();
    auto& command = *tones.add_subcommand(
        "bench", "prints the receiver's figures beside theory; exit code 1 when a goal is missed");
    command.add_flag("--full", options->full, "measure also the points that take long");
    add_shared(command, options->shared);
    command.callback([options, &exit_code] { exit_code = tones_bench(*options); });
}

}  // namespace

void add_tones_command(CLI::App& program, int& exit_code) {
    auto& tones = *program.add_subcommand("tones", "decodes and simulates X-band tones in samples");
    tones.require_subcommand(1);
    add_tones_decode(tones, exit_code);
    add_tones_simulate(tones, exit_code);
    add_tones_bench(tones, exit_code);
}

}  // namespace aeolis::server
