// SPDX-License-Identifier: Apache-2.0
// GET /metrics: figures of queues, links, commits and clients, in Prometheus text format.

#include "server/api/api.hpp"
#include "server/base/digest.hpp"
#include "server/base/version.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <sys/resource.h>
#include <unistd.h>
#include <utility>

namespace aeolis::server {
namespace {

double resident_octets() {
    std::ifstream statm{"/proc/self/statm"};
    std::uint64_t size_pages = 0, resident_pages = 0;
    statm >> size_pages >> resident_pages;
    return static_cast<double>(resident_pages) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double cpu_s() {
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

class MetricsText {
  public:
    template <typename Value>
    void gauge(std::string_view name, std::string_view help, Value value) {
        begin(name, "gauge", help);
        line(name, "", value);
    }
    template <typename Value>
    void counter(std::string_view name, std::string_view help, Value value) {
        begin(name, "counter", help);
        line(name, "", value);
    }
    void begin(std::string_view name, std::string_view type, std::string_view help) {
        fmt::format_to(std::back_inserter(text), "# HELP aeolis_{0} {2}\n# TYPE aeolis_{0} {1}\n", name, type, help);
    }
    template <typename Value>
    void line(std::string_view name, std::string_view labels, Value value) {
        fmt::format_to(std::back_inserter(text), "aeolis_{}{} {}\n", name, labels, value);
    }
    std::string text;
};

void write(MetricsText& text, const PipelineThread::Figures& pipeline) {
    text.counter("archive_deliveries_total", "deliveries taken by the pipeline", pipeline.deliveries);
    text.gauge("archive_deliveries_waiting", "deliveries in the pipeline's queue", pipeline.waiting);
    text.gauge("archive_pending_bytes", "packets and samples in memory until the disk takes them",
               pipeline.pending_octets);
    text.gauge("audit_waiting", "entries of the audit that are not durable yet", pipeline.audit_waiting);
    text.counter("archive_commits_published_total", "group commits published", pipeline.published_batches);
    text.counter("archive_failed_commits_total", "commits that failed and were tried again", pipeline.failed_commits);
    text.begin("archive_commit_seconds", "summary", "time of a commit to the disk");
    text.line("archive_commit_seconds_sum", "", pipeline.commit_s);
    text.line("archive_commit_seconds_count", "", pipeline.commits);
    text.gauge("archive_longest_commit_seconds", "the longest of them", pipeline.longest_commit_s);
    text.gauge("archive_bytes", "size of the archive's file", pipeline.archive_octets);
    text.gauge("archive_wal_bytes", "size of the archive's write-ahead log", pipeline.log_octets);
    text.counter("items_published_total", "items made durable and published", pipeline.published_items);
    text.begin("link_packets_total", "counter", "packets received over a link; of the link tones, decoded tones");
    for (const auto& [link, received] : pipeline.links)
        text.line("link_packets_total", fmt::format("{{link=\"{}\"}}", link), received.items);
    text.begin("link_octets_total", "counter", "octets of packets received over a link");
    for (const auto& [link, received] : pipeline.links)
        text.line("link_octets_total", fmt::format("{{link=\"{}\"}}", link), received.octets);
}

/// Of the run that goes on, or the last one: counters begin anew with each run.
void write(MetricsText& text, const std::map<std::string, archive::LinkTotals>& totals) {
    constexpr std::size_t sequences_max = 256;  // chosen: of a link here; all are in /proof
    text.begin("link_frames_total", "counter", "frames of a link, by what became of them");
    for (const auto& [link, told] : totals) {
        const auto& counted = told.counters;
        for (const auto& [kind, number] : {std::pair{"good", counted.frames},
                                           {"bad_crc", counted.bad_crc},
                                           {"bad_header", counted.bad_header},
                                           {"missing", counted.missing_frames},
                                           {"repeated", counted.repeated_frames},
                                           {"late", counted.late_frames},
                                           {"cut", counted.cut_frames},
                                           {"corrected", counted.corrected_frames},
                                           {"uncorrectable", counted.uncorrectable_frames},
                                           {"other_data", counted.other_data_frames}})
            text.line("link_frames_total", fmt::format("{{link=\"{}\",kind=\"{}\"}}", link, kind), number);
    }
    text.begin("link_faults_total", "counter", "what else was wrong on a link, and what was made good");
    for (const auto& [link, told] : totals)
        for (const auto& [kind, number] : {std::pair{"gaps", told.counters.gaps},
                                           {"restarts", told.counters.restarts},
                                           {"slips", told.counters.slips},
                                           {"skipped_octets", told.counters.skipped_octets},
                                           {"corrected_symbols", told.counters.corrected_symbols},
                                           {"corrected_headers", told.counters.corrected_headers},
                                           {"forgotten_channels", told.counters.forgotten_channels},
                                           {"encapsulation_packets", told.packets.encapsulation_packets},
                                           {"cut_packets", told.packets.cut_packets},
                                           {"lost_segments", told.packets.lost_segments},
                                           {"unreadable_octets", told.packets.unreadable_octets},
                                           {"bad_datagrams", told.bad_datagrams}})
            text.line("link_faults_total", fmt::format("{{link=\"{}\",kind=\"{}\"}}", link, kind), number);
    text.begin("sequence_total", "counter", "frames of a virtual channel or packets of an id, by their counts");
    for (const auto& [link, told] : totals)
        for (std::size_t i = 0; i < std::min(told.sequences.size(), sequences_max); ++i) {
            const auto& [name, packets, counted] = told.sequences[i];
            for (const auto& [kind, number] : {std::pair{"received", counted.received},
                                               {"missing", counted.missing},
                                               {"repeated", counted.repeated},
                                               {"late", counted.late},
                                               {"restarts", counted.restarts},
                                               {"wraps", counted.wraps}})
                text.line("sequence_total",
                          fmt::format("{{link=\"{}\",of=\"{}\",sequence=\"{}\",kind=\"{}\"}}", link,
                                      packets ? "packets" : "frames", name, kind),
                          number);
        }
}

void write(MetricsText& text, const StreamHub& hub) {
    const auto& figures = hub.figures;
    text.gauge("stream_clients", "WebSocket clients", hub.sessions());
    text.gauge("stream_clients_behind", "of them, those that have not been given all that is published for them",
               hub.sessions_behind());
    text.gauge("stream_clients_replaying", "of them, those that are given a run that is over, or a run again",
               hub.sessions_replaying());
    text.counter("stream_messages_total", "messages given to clients", figures.messages);
    text.counter("stream_octets_total", "octets of them", figures.octets);
    text.counter("stream_encodings_total", "batches encoded", figures.encodings);
    text.counter("stream_shared_total", "batches sent in another client's encoding", figures.shared);
    text.counter("stream_archive_pages_total", "pages that clients read from the archive", figures.archive_pages);
    text.counter("stream_refusals_total", "client messages that were refused", figures.refusals);
}

/// A client's label: its account's name. Without accounts the start of a hash, since a browser is known by the secret
/// of its cookie.
std::string label_of(const std::string& client, bool accounts) {
    constexpr std::size_t digits = 8;
    if (accounts || client == QueryThreads::other_clients) return client;
    Digest digest;
    digest.add({reinterpret_cast<const std::uint8_t*>(client.data()), client.size()});
    return digest.text().substr(0, digits);
}

void write(MetricsText& text, const std::map<std::string, QueryThreads::Waits>& waits, bool accounts) {
    text.begin("query_wait_seconds", "summary", "how long questions of a client waited for a query thread");
    for (const auto& [client, of_client] : waits) {
        const auto label = fmt::format("{{client=\"{}\"}}", label_of(client, accounts));
        text.line("query_wait_seconds_sum", label, of_client.all_s);
        text.line("query_wait_seconds_count", label, of_client.queries);
    }
    text.begin("query_longest_wait_seconds", "gauge", "the longest of these waits, by client");
    for (const auto& [client, of_client] : waits)
        text.line("query_longest_wait_seconds", fmt::format("{{client=\"{}\"}}", label_of(client, accounts)),
                  of_client.longest_s);
}

/// Counts that change with what an instructor does are for instructors.
bool tells_of_instructors(std::string_view route) {
    return route.ends_with("/plans") || route.ends_with("/rehearsals/current");
}

}  // namespace

void Api::metrics(const ApiRequest& call) {
    const bool instructs = may(call.who, Right::instruct);
    MetricsText text;
    text.begin("build_info", "gauge", "1, labelled with the program's version, its archive's schema, its dictionary");
    text.line("build_info",
              fmt::format("{{version=\"{}\",schema=\"{}\",dictionary=\"{}\"}}", version, archive::schema_version,
                          parts_.dictionary.id),
              1);
    const auto figures = parts_.pipeline.figures();
    write(text, figures);
    write(text, figures.totals);
    text.gauge("archive_fault", "1 while nothing can be stored; /healthz says why",
               parts_.pipeline.fault().empty() ? 0 : 1);
    text.counter("clock_jumps_total", "jumps of the system's clock against the monotonic clock",
                 parts_.clock_watch.jumps());
    text.gauge("clock_moved_seconds", "all these jumps together", parts_.clock_watch.moved_s());
    write(text, parts_.hub);
    text.begin("http_responses_total", "counter",
               "responses, by route and status; none: no route of the API, or no HTTP");
    {
        const std::scoped_lock lock{counts_mutex_};
        for (const auto& [of, number] : responses_)
            if (instructs || !tells_of_instructors(of.first))
                text.line("http_responses_total", fmt::format("{{route=\"{}\",status=\"{}\"}}", of.first, of.second),
                          number);
    }
    text.gauge("connections", "open HTTP and WebSocket connections", parts_.connections());
    text.counter("queries_total", "questions to the archive", parts_.queries.asked());
    text.gauge("queries_waiting", "questions that wait for a query thread", parts_.queries.waiting());
    write(text, parts_.queries.waits(), parts_.access.accounts());
    // Of a run only while it goes on: what is over is in the archive.
    const bool going_on = parts_.rehearsals.going_on();
    const auto of_run = [going_on](auto value) { return going_on ? value : decltype(value){}; };
    const auto run = parts_.rehearsals.current();
    text.gauge("run_in_progress", "1 while a rehearsal goes on", going_on ? 1 : 0);
    text.gauge("commands_waiting", "commands and command files that wait for the run's next cycle",
               of_run(parts_.rehearsals.commands_waiting()));
    text.gauge("commands_put_off", "commands and command files that wait until a change of the timeline is decided",
               parts_.rehearsals.commands_deferred());
    text.gauge("commands_queued", "commands that wait for their time, a controller, a pass or an analysis",
               of_run(parts_.rehearsals.commands_queued()));
    text.gauge("commands_at_uplink", "commands that have left the queue and are not radiated",
               of_run(parts_.rehearsals.commands_at_uplink()));
    text.gauge("run", "number of the rehearsal that goes on; 0: none does", of_run(run.run()));
    text.gauge("run_pace", "seconds of the vehicle a second, as ordered; 0: as fast as it goes, or none goes on",
               of_run(run.pace()));
    text.gauge("run_attained_pace", "seconds of the vehicle a second, as attained", of_run(run.attained_pace()));
    text.counter("process_cpu_seconds_total", "CPU time of the process", cpu_s());
    text.gauge("resident_memory_bytes", "resident memory of the process", resident_octets());
    const auto others = parts_.replication ? parts_.replication() : Replication{};
    for (const auto& [name, help, value, counter] : others.figures) {
        text.begin(name, counter ? "counter" : "gauge", help);
        text.line(name, "", value);
    }
    call.respond({200, "text/plain; version=0.0.4; charset=utf-8", "no-store", std::move(text.text)});
}

}  // namespace aeolis::server
