// SPDX-License-Identifier: Apache-2.0
#include "server/cli/ingest_tones.hpp"

#include "server/base/clock_watch.hpp"
#include "server/base/wall_clock.hpp"
#include "server/pipeline/pipeline_thread.hpp"
#include "server/tones/doppler_file.hpp"
#include "server/tones/reception_check.hpp"
#include "server/tones/sample_file.hpp"
#include "telemetry/station/ground_station.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <thread>
#include <utility>

namespace aeolis::server {
namespace {

constexpr std::int64_t second_us = 1'000'000;

Result<TimeTable> doppler_of(const std::optional<std::filesystem::path>& file) {
    return file ? read_doppler(*file) : Result<TimeTable>{TimeTable{}};
}

/// When the first sample was received: as told, as the file says, or now.
Result<Ert> start_of(const IngestTonesOptions& options, const SampleRecording& recording) {
    if (options.start) {
        if (const auto told = ert_from_text(*options.start)) return *told;
        return Error{"--start " + *options.start + ": not a UTC time, such as 2012-219T05:10:47.4"};
    }
    if (!recording.captures.empty()) {
        const CaptureTime& first = recording.captures.front();
        const double before_s = static_cast<double>(first.first_sample) / *recording.rate_hz;
        return Ert{first.time.microseconds - std::llround(before_s * 1.0e6)};
    }
    return EarthClock{read_clocks}.now();
}

struct HeardSamples {
    std::size_t tones = 0, erasures = 0, carrier = 0, spectra = 0;
    HeardRecording recording;
    void add(const telemetry::Received& received, Ert entry) {
        for (const auto& tone : received.tones) ++(tone.tone ? tones : erasures);
        carrier += received.carrier.size();
        for (const auto& each : received.carrier) {
            if (!each.estimate) continue;
            const double time_s = static_cast<double>(each.middle.microseconds - entry.microseconds) * 1.0e-6;
            recording.add({.time_s = time_s, .lock = each.lock, .frequency_hz = each.estimate->residual_hz});
        }
        spectra += received.spectra.size();
    }
};

}  // namespace

bool holds_samples(const std::filesystem::path& file) {
    const auto recording = look_at_recording(file);
    return recording && recording->kind != SampleRecording{}.kind;
}

int ingest_tones(const IngestTonesOptions& options) {
    auto dictionary = loaded_dictionary(options.dictionary);
    if (!dictionary) return 1;
    const auto recording = look_at_recording(options.samples);
    if (!recording) return failed(recording.error().message, 2);
    for (const std::string& line : recording->told) fmt::print(stderr, "{}\n", line);
    if (!recording->format || !recording->rate_hz)
        return failed(
            fmt::format("{}: {} that do not say their format and rate", options.samples.string(), recording->kind), 2);
    const double rate_hz = *recording->rate_hz;
    const auto start = start_of(options, *recording);
    if (!start) return failed(start.error().message, 2);
    const Ert entry{start->microseconds - std::llround(options.at_s * 1.0e6)};
    if (std::min(start->microseconds, entry.microseconds) < 0)
        return failed("received before 2000, or --at is too great: packets cannot hold such times", 2);
    auto predict = doppler_of(options.predict);
    if (!predict) return failed(predict.error().message);
    auto expected = doppler_of(options.expected);
    if (!expected) return failed(expected.error().message);
    if (const auto fits = telemetry::ToneReceiver::make(dictionary->mfsk, rate_hz); !fits)
        return failed(options.samples.string() + ": " + fits.error().message, 2);
    auto reader = SampleReader::open(*recording);
    if (!reader) return failed(reader.error().message);

    auto archive = archive::Archive::open(options.archive);
    if (!archive) return failed(archive.error().message);
    PipelineThread pipeline{std::move(*archive), *dictionary, PipelineThread::Faults::give_up, pipeline::Publish{}};
    pipeline.want_items(false);
    // No clock of a vehicle is known: SCLK stands for the time of reception since J2000, and entry is 0 of the
    // predict's scale.
    const auto sclk_of = [](Ert ert) { return Sclk{static_cast<double>(ert.microseconds) * 1.0e-6}; };
    archive::RunStart run_start;
    run_start.scenario = "recording";
    run_start.venue = "downlink";
    run_start.title = fmt::format("{}, {} at {} Hz", options.samples.filename().string(), recording->kind, rate_hz);
    run_start.pace = 1.0;
    run_start.started = wall_clock_text();
    run_start.start = sclk_of(*start);
    run_start.entry = sclk_of(entry);
    run_start.correlation.sclk = run_start.start;
    run_start.correlation.scet = Scet{start->microseconds};
    run_start.tone_model = "signal";
    const auto run = pipeline.begin(run_start);
    if (!run) return failed(run.error().message);
    fmt::print("run {}\n", run->value);

    SampleClaims claims{rate_hz,
                        recording->format->name(),
                        *predict,
                        *expected,
                        dictionary->mfsk.symbol_s,
                        recording->frequency_hz,
                        dictionary->mfsk.carrier_hz};
    telemetry::GroundStation station{0.0};
    if (!predict->empty()) station.watch_by({*predict, entry});
    station.listen_by(
        {dictionary->mfsk, std::move(*predict), entry, {rate_hz, std::move(*expected), options.excluded_hz}});
    HeardSamples heard;
    std::string broken;
    std::uint64_t passed = 0;
    const auto begun = std::chrono::steady_clock::now();
    std::vector<std::complex<float>> room(static_cast<std::size_t>(rate_hz));  // a second
    for (bool ended = false; !ended && broken.empty();) {
        const auto block = reader->next(room);
        if (!block) {
            broken = block.error().message;
            break;
        }
        ended = block->empty();
        telemetry::Downlink downlink;
        const auto at_us = [&](std::uint64_t samples) {
            return std::llround(static_cast<double>(samples) / rate_hz * static_cast<double>(second_us));
        };
        if (!ended)
            downlink.x_band.push_back({Ert{start->microseconds + at_us(passed)}, {block->begin(), block->end()}});
        passed += block->size();
        downlink.now = Ert{start->microseconds + at_us(passed)};
        if (options.pace > 0.0)
            std::this_thread::sleep_until(
                begun + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                            std::chrono::duration<double>(static_cast<double>(passed) / rate_hz / options.pace)));
        auto& received = station.receive(downlink);
        heard.add(received, entry);
        Delivery delivery;
        delivery.add(std::move(received));
        delivery.entries.emplace_back(telemetry::EarthTime{downlink.now});
        if (!pipeline.deliver(std::move(delivery))) broken = pipeline.fault();
    }
    const auto finished = pipeline.finish(
        {archive::Outcome::stopped, broken.empty() ? "the recording ended" : broken, "", wall_clock_text()});
    if (!broken.empty()) return failed(broken);
    if (!finished) return failed(finished.error().message);
    fmt::print("{} tones, {} erasures, {} estimates of the carrier, {} spectra\n", heard.tones, heard.erasures,
               heard.carrier, heard.spectra);
    if (const auto* status = station.tone_status()) heard.recording.status = *status;
    double& gap_s = heard.recording.status.gap_s;
    gap_s = std::max(gap_s, static_cast<double>(reader->samples_missing()) / rate_hz);
    heard.recording.tones = heard.tones;
    heard.recording.erasures = heard.erasures;
    heard.recording.length_s = static_cast<double>(passed) / rate_hz;
    heard.recording.left_over_octets = reader->left_over_octets();
    bool is_fault = !recording->told.empty();
    for (const auto& remark : check_reception(heard.recording, claims)) {
        fmt::print(stderr, "{}: {}\n", options.samples.string(), remark.text);
        is_fault = is_fault || remark.fault;
    }
    return is_fault ? 1 : 0;
}

}  // namespace aeolis::server
