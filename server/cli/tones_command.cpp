// SPDX-License-Identifier: Apache-2.0
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/rehearsal/predicted_doppler.hpp"
#include "server/tones/doppler_file.hpp"
#include "server/tones/flown_signal.hpp"
#include "server/tones/reception_check.hpp"
#include "server/tones/sample_file.hpp"
#include "server/tones/tone_bench.hpp"
#include "simulation/links/x_band_channel.hpp"
#include "telemetry/mfsk/tone_receiver.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <memory>

namespace aeolis::server {
namespace {

struct TonesDecodeOptions {
    SharedOptions shared;
    std::filesystem::path samples;
    std::optional<double> rate_hz;                  ///< none: as the file says
    std::optional<std::string> format;              ///< the same
    std::optional<std::filesystem::path> predict;   ///< Doppler removed before sampling
    std::optional<std::filesystem::path> expected;  ///< Doppler still in the samples
    std::optional<std::filesystem::path> carrier;   ///< the carrier is written here
    double start_s = 0.0;                           ///< of the first sample, on the predict's time axis
    std::vector<double> excluded_hz;                ///< lines in the samples that are left out
    std::optional<double> symbols_from_s;           ///< symbols begin then and directly after each other
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

/// A recording with its rate and format, from the file or, where it says nothing, from the options.
Result<SampleRecording> recording_of(const TonesDecodeOptions& options) {
    auto looked = look_at_recording(options.samples);
    if (!looked) return looked;
    SampleRecording& recording = *looked;
    if (options.format) {
        const auto format = sample_format(*options.format);
        if (!format) return format.error();
        if (recording.format && *recording.format != *format)
            recording.told.push_back(fmt::format("{}: is {} by its header, not {} as --format says; the header is used",
                                                 options.samples.string(), recording.format->name(), format->name()));
        if (!recording.format) recording.format = *format;
    }
    if (options.rate_hz) {
        if (recording.rate_hz && *recording.rate_hz != *options.rate_hz)
            recording.told.push_back(
                fmt::format("{}: has {} samples a second by its header, not {} as --rate says; the "
                            "header is used",
                            options.samples.string(), *recording.rate_hz, *options.rate_hz));
        if (!recording.rate_hz) recording.rate_hz = options.rate_hz;
    }
    if (!recording.format)
        return Error{fmt::format("{}: {} that do not say their format; give --format", options.samples.string(),
                                 recording.kind)};
    if (!recording.rate_hz)
        return Error{
            fmt::format("{}: {} that do not say their rate; give --rate", options.samples.string(), recording.kind)};
    return looked;
}

/// Adds the counts of a receiver that began anew behind a hole in the file.
void add(const telemetry::ReceiverStatus& part, telemetry::ReceiverStatus& sum) {
    telemetry::ReceiverStatus all = part;
    all.carrier_s += sum.carrier_s;
    all.without_s += sum.without_s;
    all.gap_s += sum.gap_s;
    all.acquisitions += sum.acquisitions;
    all.contradicted += sum.contradicted;
    all.loudest = std::max(all.loudest, sum.loudest);
    if (!all.clock_error_ppm) all.clock_error_ppm = sum.clock_error_ppm;
    for (const double hz : sum.left_out_hz)
        if (std::ranges::none_of(part.left_out_hz, [&](double other) { return std::abs(other - hz) < 1.0; }))
            all.left_out_hz.push_back(hz);
    sum = all;
}

void write_carrier(std::ofstream& file, const telemetry::CarrierReport& report) {
    if (report.lock == CarrierLock::searching)
        file << fmt::format("{:.4f},{},,,,\n", report.time_s, to_text(report.lock));
    else if (std::isnan(report.total_c_n0_dbhz))
        file << fmt::format("{:.4f},{},{:.3f},,{:.2f},\n", report.time_s, to_text(report.lock), report.frequency_hz,
                            report.rate_hzps);
    else
        file << fmt::format("{:.4f},{},{:.3f},{:.3f},{:.2f},{:.2f}\n", report.time_s, to_text(report.lock),
                            report.frequency_hz, report.frequency_deviation_hz, report.rate_hzps,
                            report.total_c_n0_dbhz);
}

/// Prints one line per symbol. Returns 1 for silence, no carrier, a long carrier without symbols, and whatever
/// contradicts what is said of the samples.
int tones_decode(const TonesDecodeOptions& options) {
    const auto dictionary = loaded_dictionary(options.shared.dictionary);
    if (!dictionary) return 1;
    const auto recording = recording_of(options);
    if (!recording) return failed(recording.error().message, 2);
    for (const std::string& line : recording->told) fmt::print(stderr, "{}\n", line);
    const double rate_hz = *recording->rate_hz;
    const auto predict = optional_doppler(options.predict);
    if (!predict) return failed(predict.error().message);
    const auto expected = optional_doppler(options.expected);
    if (!expected) return failed(expected.error().message);
    auto reader = SampleReader::open(*recording);
    if (!reader) return failed(reader.error().message);
    if (recording->kind != "raw samples")
        fmt::print(stderr, "{}: {}, {} at {} Hz{}{}\n", options.samples.string(), recording->kind,
                   recording->format->name(), rate_hz,
                   recording->frequency_hz ? fmt::format(", middle {} Hz", *recording->frequency_hz) : "",
                   recording->datetime.empty() ? "" : ", from " + recording->datetime);
    std::ofstream carrier;
    if (options.carrier) {
        carrier.open(*options.carrier);
        carrier << "time_s,lock,frequency_hz,frequency_deviation_hz,rate_hzps,c_n0_dbhz\n";
    }

    std::optional<telemetry::ToneReceiver> receiver;
    std::uint64_t passed = 0;
    const auto begin = [&]() -> Result<void> {
        const double start_s = options.start_s + static_cast<double>(passed) / rate_hz;
        auto made = telemetry::ToneReceiver::make(
            dictionary->mfsk, rate_hz, {*predict, start_s, *expected, options.excluded_hz, options.symbols_from_s});
        if (!made) return made.error();
        receiver.emplace(std::move(*made));
        return {};
    };
    if (const auto begun = begin(); !begun) return failed(begun.error().message, 2);

    HeardRecording heard;
    const auto take = [&] {
        for (const telemetry::ToneReception& symbol : receiver->take()) {
            print(symbol, *dictionary, options.json);
            ++(symbol.tone ? heard.tones : heard.erasures);
        }
        for (const telemetry::CarrierReport& report : receiver->take_carrier()) {
            if (carrier.is_open()) write_carrier(carrier, report);
            heard.add(report);
        }
    };
    std::vector<std::complex<float>> room(block_samples);
    for (;;) {
        const auto block = reader->next(room);
        if (!block) return failed(block.error().message);
        if (block->empty()) break;
        receiver->push(*block);
        passed += block->size();
        take();
        // What a sparse file does not store needs no receiver.
        if (std::ranges::any_of(*block, [](const auto& sample) { return sample != std::complex<float>{}; })) continue;
        const std::uint64_t hole = reader->skip_hole();
        if (hole == 0) continue;
        receiver->finish();
        take();
        add(receiver->status(), heard.status);
        heard.status.gap_s += static_cast<double>(hole) / rate_hz;
        passed += hole;
        if (const auto begun = begin(); !begun) return failed(begun.error().message, 2);
    }
    receiver->finish();
    take();
    add(receiver->status(), heard.status);
    if (options.carrier) {
        carrier.close();
        if (!carrier) return failed(fmt::format("{} cannot be written", options.carrier->string()));
    }

    heard.length_s = static_cast<double>(reader->samples()) / rate_hz;
    heard.left_over_octets = reader->left_over_octets();
    bool is_fault = !recording->told.empty();
    for (const auto& remark :
         check_reception(heard, {rate_hz, recording->format->name(), *predict, *expected, dictionary->mfsk.symbol_s,
                                 recording->frequency_hz, dictionary->mfsk.carrier_hz})) {
        fmt::print(stderr, "{}: {}\n", options.samples.string(), remark.text);
        is_fault = is_fault || remark.fault;
    }
    return is_fault ? 1 : 0;
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

    const std::string extension = options.out.extension().string();
    const bool is_sigmf = extension == ".sigmf-meta" || extension == ".sigmf-data" || extension == ".sigmf";
    std::filesystem::path data = options.out, meta = options.out;
    if (is_sigmf) data.replace_extension(".sigmf-data");
    auto writer = SampleWriter::open(data, *format);
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
    if (is_sigmf) {
        std::ofstream stream{meta.replace_extension(".sigmf-meta")};
        stream << sigmf_meta(*format, options.rate_hz, words->mfsk.carrier_hz,
                             fmt::format("simulated X-band tones from {} s on", sending->path.start_s));
        stream.close();
        if (!stream) return failed(fmt::format("{} cannot be written", meta.string()));
    }
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
    auto& command = *tones.add_subcommand("decode", "prints the tones in a file of complex samples, a line per symbol");
    command.add_option("--samples", options->samples, "the file: SigMF, WAV of two channels, or raw samples")
        ->required();
    command.add_option("--rate", options->rate_hz, "samples per second; SigMF and WAV files state it");
    command.add_option("--format", options->format,
                       "for raw samples: cf32, cf64, ci8, cu8, ci16, ci32; big-endian with _be");
    command.add_option("--predict", options->predict, "CSV of the Doppler that was removed: time, doppler_hz");
    command.add_option("--start", options->start_s, "time of the first sample [s]")->capture_default_str();
    command.add_option("--expected", options->expected,
                       "CSV of the Doppler that is still in the samples, of a fixed oscillator: time, doppler_hz");
    command.add_option("--carrier", options->carrier, "CSV to write: the carrier, eight rows a second");
    command.add_option("--exclude", options->excluded_hz, "lines to remove from the samples [Hz]; 0 is a DC block")
        ->delimiter(',');
    command.add_option("--symbols-from", options->symbols_from_s,
                       "symbols begin at this time [s] and directly after each other: each is decided at its end");
    command.add_flag("--json", options->json, "print a JSON object per line");
    add_shared(command, options->shared);
    command.callback([options, &exit_code] { exit_code = tones_decode(*options); });
}

void add_tones_simulate(CLI::App& tones, int& exit_code) {
    const auto options = std::make_shared<TonesSimulateOptions>();
    auto& command = *tones.add_subcommand("simulate", "writes a file of samples, from lists or from a landing");
    command.add_option("--out", options->out, "file to write; as SigMF if it ends in .sigmf-meta or .sigmf-data")
        ->required();
    command.add_option("--rate", options->rate_hz, "samples per second")->capture_default_str();
    command.add_option("--format", options->format, "cf32, cf64, ci8, cu8, ci16, ci32; big-endian with _be")
        ->capture_default_str();
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
