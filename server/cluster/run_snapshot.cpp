// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/run_snapshot.hpp"

#include <fmt/format.h>
#include <utility>

namespace aeolis::server::cluster {
namespace {

constexpr unsigned octet_bits = 8;

std::string framed(const std::string& message) {
    std::string octets;
    octets.reserve(frame_head_octets + message.size());
    for (std::size_t place = frame_head_octets; place-- > 0;)
        octets.push_back(static_cast<char>(message.size() >> (octet_bits * place)));
    return octets + message;
}

std::size_t length_of(std::string_view head) {
    std::size_t length = 0;
    for (const char octet : head) length = length << octet_bits | static_cast<unsigned char>(octet);
    return length;
}

}  // namespace

RunSnapshot::RunSnapshot(archive::RunRowsReader reader, v1::RunRows head, v1::RunPosition held)
    : reader_(std::move(reader)), head_(std::move(head)), position_(std::move(held)) {}

Result<RunSnapshot> RunSnapshot::begin(const std::filesystem::path& archive, archive::RunId run, v1::RunPosition held) {
    auto reader = archive::RunRowsReader::open(archive);
    if (!reader) return reader.error();
    const auto origin = reader->origin();
    if (!origin) return origin.error();
    if (origin->empty())
        return Error{"nobody follows this archive: it was never published (serve --nats), and follows none"};
    const auto stored = reader->run(run);
    if (!stored) return stored.error();
    if (!*stored) return Error{fmt::format("run {}: there is none", run.value)};
    if ((*stored)->last_seq < held.seq())
        return Error{fmt::format("run {}: this archive has items up to {}, not up to {}", run.value,
                                 (*stored)->last_seq, held.seq())};
    v1::RunRows head;
    head.set_archive(*origin);
    head.set_run(run.value);
    head.set_tables(reader->tables());
    return RunSnapshot{std::move(*reader), std::move(head), std::move(held)};
}

Result<std::optional<std::string>> RunSnapshot::next() {
    using Message = std::optional<std::string>;
    if (messages_.empty() && !whole_) {
        auto step = reader_.next(archive::RunId{head_.run()}, position_, true);
        if (!step) return step.error();
        whole_ = !*step || (*step)->rows.whole();
        if (*step) {
            for (auto& message : messages_of(**step, head_)) messages_.push_back(framed(message));
            position_ = (*step)->after;
        }
    }
    if (messages_.empty()) return Message{};
    Message message{std::move(messages_.front())};
    messages_.pop_front();
    return message;
}

Result<std::optional<v1::RunRows>> FramedMessages::next() {
    using Message = std::optional<v1::RunRows>;
    if (octets_.size() < frame_head_octets) return Message{};
    const auto length = length_of(std::string_view{octets_}.substr(0, frame_head_octets));
    if (length > framed_octets_max) return Error{"this is no run as a server sends it"};
    if (octets_.size() < frame_head_octets + length) return Message{};
    auto message = run_rows_of(std::string_view{octets_}.substr(frame_head_octets, length));
    if (!message) return message.error();
    octets_.erase(0, frame_head_octets + length);
    return Message{std::move(*message)};
}

}  // namespace aeolis::server::cluster
