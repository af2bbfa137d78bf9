// SPDX-License-Identifier: Apache-2.0
#include "server/cli/ingest_radio.hpp"

#include "common/space_packet.hpp"
#include "server/base/wall_clock.hpp"
#include "server/cli/ingest_delivery.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "telemetry/decoded_packet.hpp"
#include "telemetry/station/ground_station.hpp"
#include "telemetry/station/link_ledger.hpp"
#include "telemetry/station/recording_progress.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <utility>

namespace aeolis::server {
namespace {

constexpr std::int64_t radio_second_us = 1'000'000;
constexpr std::int64_t seconds_told_max = 3600;  // chosen: of a longer silence the last hour passes by seconds
constexpr std::size_t radio_delivery_entries = 256;

struct RecordedLink {
    telemetry::Link link;
    std::optional<std::uint16_t> port;  ///< of a capture
};

Result<RecordedLink> link_of(const std::string& text) {
    const auto at = text.find('=');
    RecordedLink read{{text.substr(0, at), false}, {}};
    const std::string& name = read.link.name;
    if (name == telemetry::x_band_link.name)
        return Error{"--link x_band: it has samples, which SigMF and WAV hold, and needs no --link"};
    const auto is_of_orbiter = [&](std::string_view prefix) {
        return name.starts_with(prefix) && name.size() > prefix.size();
    };
    read.link.recorded = name == telemetry::relay_link.name || is_of_orbiter("relay_");
    const bool known = read.link.recorded || name == telemetry::x_band_telemetry_link.name || is_of_orbiter("uhf_");
    if (!known)
        return Error{fmt::format("--link {}: our own mission has uhf_live, uhf_ORBITER, relay, relay_ORBITER and "
                                 "x_band_telemetry",
                                 name)};
    if (at == std::string::npos) return read;
    const std::string port = text.substr(at + 1);
    std::uint16_t number = 0;
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
    if (error != std::errc{} || end != port.data() + port.size() || number == 0)
        return Error{fmt::format("--link {}: '{}' is no UDP port", text, port)};
    read.port = number;
    return read;
}

Result<std::vector<RecordedLink>> links_of(const std::vector<std::string>& texts) {
    std::vector<RecordedLink> links;
    for (const auto& text : texts) {
        auto link = link_of(text);
        if (!link) return link.error();
        if (texts.size() > 1 && !link->port)
            return Error{fmt::format("--link {}: of several each needs its port, as {}=4200", text, text)};
        for (const auto& other : links)
            if (other.link == link->link || other.port == link->port)
                return Error{fmt::format("--link {}: given before, or its port", text)};
        links.push_back(std::move(*link));
    }
    return links;
}

/// Ends a station's waiting for the rest of what was cut off, as time passes without octets.
constexpr std::int64_t quiet_us = static_cast<std::int64_t>(telemetry::GroundStation::quiet_s * radio_second_us) + 1;

/// Receives pieces as a station does, to whom time passes between them too.
class Reception {
  public:
    explicit Reception(double light_time_s) : station_(light_time_s) {}

    template <typename Take>  // of telemetry::Received&
    void receive(const telemetry::Link& link, const RecordedPiece& piece, const Take& take) {
        end(piece.ert, take);
        telemetry::Downlink downlink;
        downlink.now = last_ = std::max(last_, piece.ert);
        downlink.octets.push_back({link, downlink.now, {piece.octets.begin(), piece.octets.end()}, false});
        pass(downlink, take);
        heard_ = true;
    }
    /// Lets time pass up to `now`.
    template <typename Take>
    void end(Ert now, const Take& take) {
        if (!heard_ || now.microseconds - last_.microseconds <= quiet_us) return;
        telemetry::Downlink silence;
        silence.now = {last_.microseconds + quiet_us};
        heard_ = false;
        pass(silence, take);
    }
    /// The newest reception, and the end of the silence after it.
    Ert last() const { return last_; }
    Ert quiet() const { return {last_.microseconds + quiet_us + 1}; }
    telemetry::GroundStation& station() { return station_; }

  private:
    template <typename Take>
    void pass(const telemetry::Downlink& downlink, const Take& take) {
        take(station_.receive(downlink));
        station_.take_forward();  // nobody is there to be asked for what is missing
    }

    telemetry::GroundStation station_;
    Ert last_;
    bool heard_ = false;  ///< since time last passed without octets
};

/// The octets of one link in the recording. A capture may hold several, also one after the other.
class LinkSource {
  public:
    static Result<std::unique_ptr<LinkSource>> open(const IngestRadioOptions& options, const RecordedLink& link,
                                                    Ert start) {
        auto source = std::make_unique<LinkSource>();
        source->link = link.link;
        source->options_ = options.octets;
        if (link.port) source->options_.ports = {*link.port};
        auto files = RecordedFiles::open(options.files, source->options_, start);
        if (!files) return files.error();
        source->files_.emplace(std::move(*files));
        source->go_on();
        return source;
    }
    LinkSource() = default;
    LinkSource(const LinkSource&) = delete;
    LinkSource& operator=(const LinkSource&) = delete;
    ~LinkSource() = default;

    telemetry::Link link;
    std::optional<RecordedPiece> next;  ///< none: no more

    void go_on() {
        next.reset();
        while (!next) {
            if (!cursor_) {
                if (file_ == files_->recordings().size()) return;
                cursor_.emplace(files_->recordings()[file_++]);
            }
            next = cursor_->next();
            if (!next) cursor_.reset();
        }
    }

  private:
    RecordedOctetsOptions options_;
    std::optional<RecordedFiles> files_;
    std::size_t file_ = 0;
    std::optional<RecordingCursor> cursor_;
};
using LinkSources = std::vector<std::unique_ptr<LinkSource>>;

Result<LinkSources> sources_of(const IngestRadioOptions& options, const std::vector<RecordedLink>& links, Ert start) {
    LinkSources sources;
    for (const auto& link : links) {
        auto source = LinkSource::open(options, link, start);
        if (!source) return source.error();
        sources.push_back(std::move(*source));
    }
    return sources;
}

/// The source of what was received next; null: no more.
LinkSource* earliest(const LinkSources& sources) {
    LinkSource* earliest = nullptr;
    for (const auto& source : sources)
        if (source->next && (earliest == nullptr || source->next->ert < earliest->next->ert)) earliest = source.get();
    return earliest;
}

/// The time in the first packet.
std::optional<Sclk> first_time(const LinkSources& sources) {
    Reception reception{0.0};
    std::optional<Sclk> first;
    const auto look = [&](telemetry::Received& received) {
        for (const auto& packet : received.packets)
            if (const auto header = read_tm_packet(packet.octets); header && !first) first = header->time;
    };
    for (LinkSource* source = earliest(sources); source != nullptr && !first; source = earliest(sources)) {
        reception.receive(source->link, *source->next, look);
        source->go_on();
    }
    reception.end(reception.quiet(), look);
    return first;
}

/// What is known of the mission's times.
struct Times {
    archive::RunStart start;
    double light_time_s = 0.0;
};
Times times_of(const std::optional<simulation::Scenario>& scenario, const dictionary::Dictionary& dictionary,
               Sclk first) {
    Times times;
    auto& start = times.start;
    start.start = first;
    if (const auto* known = dictionary.clock_at(first)) start.correlation = *known;
    if (scenario) {
        start.correlation = clock_of(*scenario, dictionary);
        start.entry = scenario->entry_sclk;
        start.light_time_s = times.light_time_s = scenario->radio.light_time_s;
    }
    return times;
}

/// Hands what the station receives to the archive.
class RadioIngest {
  public:
    RadioIngest(double light_time_s, double pace, const dictionary::Dictionary& dictionary, PipelineThread& pipeline)
        : reception_(light_time_s), pace_(pace), decoder_(dictionary), progress_(dictionary), delivery_(pipeline) {}

    Result<void> take(const LinkSources& sources) {
        for (LinkSource* source = earliest(sources); source != nullptr; source = earliest(sources)) {
            if (auto taken = take(source->link, *source->next); !taken) return taken;
            source->go_on();
        }
        return hand_over();
    }

    /// Names what of a file is not used.
    void look_at(const Recording& recording, const std::string& name) {
        bool empty = true;
        const auto unused = recording.each([&](const RecordedPiece& piece) {
            empty = empty && piece.octets.empty();
            return true;
        });
        if (!unused.empty()) delivery_.fault(name + ": " + unused);
        if (empty) delivery_.fault(name + ": no octets of a link are in it");
    }

    /// Hands over the totals. False when it was not as it should be.
    Result<bool> finish(const std::vector<RecordedLink>& links) {
        pass_to(reception_.quiet());
        auto totals = reception_.station().link_totals(reception_.last());
        for (const auto& [link, port] : links) {
            const auto found = std::ranges::find(totals, link.name, &telemetry::LinkTotals::link);
            if (found == totals.end()) {
                delivery_.fault(link.name + ": no octets of it are there");
                continue;
            }
            fmt::print("{}: {} packets of {} octets\n", link.name, packets_[link.name], found->counters.octets);
            if (const auto faults = telemetry::LinkLedger{link.name}.faults_since(*found); !faults.empty())
                delivery_.fault(link.name + ": " + faults);
        }
        for (const auto& link : reception_.station().links())
            if (const auto stray = link.pltus.stray_octets(); stray > 0)
                delivery_.fault(
                    fmt::format("{}: {} octets skipped that are neither good frames nor fill", link.link.name, stray));
        const auto& files = reception_.station().recording();
        if (files.refused() + reception_.station().unreadable_file_octets() > 0)
            delivery_.fault(fmt::format("{} file units refused, {} octets of files unreadable", files.refused(),
                                        reception_.station().unreadable_file_octets()));
        if (files.files_under_way() > 0)
            delivery_.fault(fmt::format("{} files of the recording on board are not whole", files.files_under_way()));
        delivery_.next.links = std::move(totals);
        if (auto done = hand_over(); !done) return done.error();
        return delivery_.is_clean();
    }

  private:
    Result<void> take(const telemetry::Link& link, const RecordedPiece& piece) {
        pace_.wait_for(piece.ert);
        pass_to(piece.ert);
        if (!packets_.contains(link.name)) {
            packets_[link.name] = 0;
            delivery_.next.entries.emplace_back(telemetry::LinkState{link, piece.ert, true, "recorded", false});
        }
        reception_.receive(link, piece, [&](telemetry::Received& received) { collect(received); });
        const bool due = delivery_.next.entries.size() >= radio_delivery_entries || pace_.waits();
        return due ? hand_over() : Result<void>{};
    }

    /// Time passes for archive and station alike.
    void pass_to(Ert ert) {
        reception_.end(ert, [&](telemetry::Received& received) { collect(received); });
        if (ert.microseconds - passed_.microseconds < radio_second_us) return;
        const std::int64_t seconds =
            std::min((ert.microseconds - passed_.microseconds) / radio_second_us, seconds_told_max);
        for (std::int64_t left = packets_.empty() ? 1 : seconds; left-- > 0;)
            delivery_.next.entries.emplace_back(telemetry::EarthTime{Ert{ert.microseconds - left * radio_second_us}});
        passed_ = ert;
        delivery_.next.links = reception_.station().link_totals(ert);
    }

    void collect(telemetry::Received& received) {
        for (auto& packet : received.packets) {
            ++packets_[packet.link.name];
            if (!telemetry::is_live_telemetry(packet.link.name)) continue;
            auto decoded = std::make_shared<telemetry::DecodedPacket>();
            decoder_.decode(packet.octets, *decoded);
            if (decoded->refusal.empty()) progress_.note(decoded->content);
            packet.decoded = std::move(decoded);
        }
        delivery_.next.add(std::move(received));
    }

    Result<void> hand_over() {
        delivery_.next.relay_progress = progress_.fraction(reception_.station().recording());
        return delivery_.hand_over();
    }

    Reception reception_;
    RecordedPace pace_;
    telemetry::PacketDecoder decoder_;
    telemetry::RecordingProgress progress_;
    IngestDelivery delivery_;
    Ert passed_;
    std::map<std::string, std::uint64_t> packets_;  ///< by link
};

}  // namespace

int ingest_radio(IngestRadioOptions options) {
    const auto links = links_of(options.links);
    if (!links) return failed(links.error().message, 2);
    if (const auto checked = check_rate(options.octets, options.files); !checked)
        return failed(checked.error().message, 2);
    auto dictionary = loaded_dictionary(options.shared.dictionary);
    if (!dictionary) return 1;
    std::optional<simulation::Scenario> scenario;
    if (options.scenario) {
        auto given = scenario_given(*options.scenario, options.shared.scenarios);
        if (!given) return failed(given.error().message, 2);
        scenario = std::move(*given);
    }
    options.octets.select_by = "--link NAME=PORT";
    for (const auto& link : *links)
        if (link.port) options.octets.ports.push_back(*link.port);
    std::optional<Ert> told;
    if (options.octets.start) {
        told = ert_from_text(*options.octets.start);
        if (!told)
            return failed("--start " + *options.octets.start + ": not a UTC time, such as 2012-219T05:10:47.4", 2);
    }
    const auto& name = options.files.front();
    const auto files = RecordedFiles::open(options.files, options.octets, told.value_or(Ert{}));
    if (!files) return failed(files.error().message, 2);
    for (std::size_t i = 0; i < options.files.size(); ++i) {
        if (files->recordings()[i].is_capture()) continue;
        if (links->size() > 1)
            return failed(options.files[i].string() + ": not a capture, so of one link; several are given", 2);
        if (links->front().port)
            return failed(options.files[i].string() + ": not a capture, so without ports: --link NAME is wanted", 2);
    }
    auto sources = sources_of(options, *links, told.value_or(Ert{}));
    if (!sources) return failed(sources.error().message, 2);
    const auto first = first_time(*sources);
    if (!first)
        return failed(fmt::format("{}: no packet of our own mission is in it; is it a recording of {}?", name.string(),
                                  options.links.front()));
    auto [start, light_time_s] = times_of(scenario, *dictionary, *first);
    const Ert own{start.correlation.scet_of(*first).microseconds +
                  static_cast<std::int64_t>(light_time_s * radio_second_us)};
    if (!told && !files->recordings().front().is_capture())
        fmt::print(stderr, "{}: taken for received at {}, by the first packet's own time: no times are in it\n",
                   name.string(), day_of_year_text(own));
    sources = sources_of(options, *links, told.value_or(own));  // from their beginning
    if (!sources) return failed(sources.error().message, 2);

    auto archive = archive::Archive::open(options.archive);
    if (!archive) return failed(archive.error().message);
    PipelineThread pipeline{std::move(*archive), *dictionary, PipelineThread::Faults::give_up, pipeline::Publish{}};
    pipeline.want_items(false);
    start.scenario = "recording";
    start.venue = "downlink";
    start.title = fmt::format("{}, octets of {}", name.filename().string(), fmt::join(options.links, ", "));
    start.pace = 1.0;
    start.started = wall_clock_text();
    const auto run = pipeline.begin(start);
    if (!run) return failed(run.error().message);
    fmt::print("run {}\n", run->value);
    RadioIngest ingest{light_time_s, options.pace, *dictionary, pipeline};
    for (std::size_t i = 0; i < files->recordings().size(); ++i)
        ingest.look_at(files->recordings()[i], options.files[i].string());
    std::optional<Error> broken;
    if (auto taken = ingest.take(*sources); !taken) broken = taken.error();
    const auto right = ingest.finish(*links);
    const auto finished = pipeline.finish(
        {archive::Outcome::stopped, broken ? broken->message : "the recording ended", "", wall_clock_text()});
    if (broken) return failed(broken->message);
    if (!right) return failed(right.error().message);
    if (!finished) return failed(finished.error().message);
    if (pipeline.not_decoded() > 0) fmt::print(stderr, "{} packets not decoded\n", pipeline.not_decoded());
    return *right && pipeline.not_decoded() == 0 ? 0 : 1;
}

}  // namespace aeolis::server
