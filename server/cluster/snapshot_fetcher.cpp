// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/snapshot_fetcher.hpp"

#include "aeolis/v1/run.pb.h"
#include "server/base/json.hpp"

#include <fmt/format.h>
#include <utility>

namespace aeolis::server::cluster {
namespace {

constexpr unsigned status_ok = 200, status_not_found = 404;
constexpr std::size_t list_octets_max = 8U << 20U;  // chosen: ten times a page of a thousand runs
constexpr std::size_t held_octets_max = 8U << 10U;  // half of what a server takes as a request's head
constexpr std::size_t words_max = 300;              // of a refusal

/// What may not stand in a query as it is, percent-encoded [RFC 3986, 2.1].
std::string encoded(std::string_view text) {
    std::string all;
    for (const unsigned char octet : text) {
        const bool plain = (octet >= '0' && octet <= '9') || (octet >= 'a' && octet <= 'z') ||
                           (octet >= 'A' && octet <= 'Z') || octet == '_' || octet == '-' || octet == '.';
        all += plain ? std::string(1, static_cast<char>(octet)) : fmt::format("%{:02X}", octet);
    }
    return all;
}

std::string text_of(v1::RunPosition held) {
    auto text = encoded(to_json(held));
    if (text.size() <= held_octets_max) return text;
    held.clear_raw();  // then octets of links come again, and are passed over
    return encoded(to_json(held));
}

/// Why a request has not brought what was asked for.
std::string fault_of(const Result<SnapshotSource::Answer>& answer) {
    if (!answer) return answer.error().message;
    if (!answer->lost.empty()) return answer->lost;
    if (answer->status == status_ok) return {};
    v1::ErrorReply problem;
    const auto words = from_json(answer->body, problem) ? problem.detail() : "it is no server of this version";
    return fmt::format("it answers {}: {}", answer->status, words.substr(0, words_max));
}

}  // namespace

SnapshotFetcher::SnapshotFetcher(SnapshotSource source) : source_(std::move(source)) {
    thread_ = std::thread{[this] { run(); }};
}

SnapshotFetcher::~SnapshotFetcher() {
    {
        const std::scoped_lock lock{mutex_};
        stop_ = true;
    }
    wake_.notify_all();
    news_.close();
    thread_.join();
}

void SnapshotFetcher::list() {
    ask({});
}
void SnapshotFetcher::fetch(archive::RunId run, const v1::RunPosition& held) {
    ask({run, held});
}

void SnapshotFetcher::ask(Asked asked) {
    broken_off_ = false;
    {
        const std::scoped_lock lock{mutex_};
        asked_ = std::move(asked);
    }
    wake_.notify_all();
}

std::optional<SnapshotFetcher::News> SnapshotFetcher::next() {
    return news_.pop_until({});
}

void SnapshotFetcher::run() {
    for (;;) {
        Asked asked;
        {
            std::unique_lock lock{mutex_};
            wake_.wait(lock, [this] { return stop_ || asked_; });
            if (stop_) return;
            asked = *std::exchange(asked_, std::nullopt);
        }
        if (!news_.push(asked.run.value == 0 ? answer_of_list() : News{answer_of_run(asked)})) return;
    }
}

SnapshotFetcher::News SnapshotFetcher::answer_of_list() {
    Listed all;
    for (std::uint64_t after = 0;;) {
        std::string body;
        const auto answer = source_.get(
            fmt::format("/api/v1/runs?order=oldest&after={}", after),
            [&](std::string_view part) {
                body += part;
                return body.size() <= list_octets_max;
            },
            [this] { return stop_.load(); });
        if (auto fault = fault_of(answer); !fault.empty()) return Ended{std::move(fault)};
        v1::RunList page;
        if (!from_json(body, page)) return Ended{"its list of runs is not understood: it is no server of this version"};
        for (const auto& run : page.runs())
            all.push_back({archive::RunId{static_cast<std::uint32_t>(run.run())}, run.last_seq()});
        if (page.next_after() == 0) return all;
        if (page.next_after() <= after || all.size() > runs_max) return Ended{"its list of runs has no end"};
        after = page.next_after();
    }
}

SnapshotFetcher::Ended SnapshotFetcher::answer_of_run(const Asked& asked) {
    FramedMessages messages;
    std::string broken;
    const auto take = [&](std::string_view part) {
        messages.add(part);
        for (;;) {
            auto message = messages.next();
            if (!message) broken = message.error().message;
            if (!message || broken_off_) return false;
            if (!*message) return true;
            if (!news_.push(News{std::move(**message)})) return false;
        }
    };
    const auto answer = source_.get(fmt::format("/api/v1/runs/{}/rows?held={}", asked.run.value, text_of(asked.held)),
                                    take, [this] { return stop_ || broken_off_; });
    if (!broken.empty()) return {std::move(broken)};
    auto fault = fault_of(answer);
    if (fault.empty() && messages.within()) fault = "its answer ends within a message";
    return {std::move(fault), answer && answer->status == status_not_found};
}

}  // namespace aeolis::server::cluster
