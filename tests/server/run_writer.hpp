// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/archive.hpp"
#include "server/archive/kept_request.hpp"

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

namespace aeolis::test {

/// Writes rows of every list of a run straight into an archive, without a flight. Throws what the archive refuses.
class RunWriter {
  public:
    static constexpr std::uint64_t items_a_round = 14;

    RunWriter(archive::Archive& archive, archive::RunId run, std::string words = "as planned")
        : archive_(archive), run_(run), words_(std::move(words)) {}

    /// Each round: a packet, an event, a tone, a decision, an alarm, a note, an intervention, and a command's stages.
    void add(std::uint64_t rounds) {
        archive::Batch batch;
        batch.first_seq = seq_ + 1;
        batch.octets.assign(64, 0xA5);
        for (std::uint64_t i = 0; i < rounds; ++i) add_round(batch);
        batch.last_seq = seq_;
        append(batch);
    }
    void finish() {
        archive::Batch batch;
        batch.end = archive::RunEnd{archive::Outcome::stopped, "", "", "2026-11-22T12:00:00Z"};
        append(batch);
    }
    std::uint64_t rounds() const { return rounds_; }

  private:
    void append(const archive::Batch& batch) {
        if (const auto done = archive_.append(run_, batch); !done) throw std::runtime_error(done.error().message);
    }
    archive::ItemRecord next() { return {++seq_, Ert{static_cast<std::int64_t>(seq_) * 1'000}}; }
    template <typename Record>
    Record& item(std::vector<Record>& records) {
        auto& record = records.emplace_back();
        static_cast<archive::ItemRecord&>(record) = next();
        return record;
    }
    void add_round(archive::Batch& batch) {
        ++rounds_;
        const auto sclk = Sclk{1000.0 + static_cast<double>(rounds_)};
        auto& packet = item(batch.packets);
        packet.apid = Apid{0x20};
        packet.sclk = sclk;
        packet.link = "uhf_live";
        packet.source = archive::Source::realtime;
        packet.octets = {0, batch.octets.size()};
        auto& event = item(batch.events);
        event.name = "TOUCHDOWN";
        event.text = words_;
        event.sclk = sclk;
        event.source = archive::Source::realtime;
        auto& tone = item(batch.tones);
        tone.name = "nominal";
        tone.meaning = words_;
        tone.model = "signal";
        tone.sclk = sclk;
        tone.best.assign(5, {});
        auto& decision = item(batch.explanations);
        decision.sclk = sclk;
        decision.source = archive::Source::realtime;
        decision.explanation.text = words_;
        decision.explanation.decision = "hold";
        auto& alarm = item(batch.alarms);
        alarm.sclk = sclk;
        alarm.limit = "> 1 m";
        auto& note = item(batch.notes);
        note.text = words_;
        note.by = "Ada";
        for (unsigned stage = 0; stage < 8; ++stage) {
            auto& reached = item(batch.stages);
            reached.command = rounds_;
            reached.name = "NO_OP";
            reached.stage = static_cast<commands::Stage>(stage);
            reached.status = commands::Status::ok;
            reached.evidence = words_;
            if (stage == 0) reached.octets.assign(32, 0x5A);
        }
        v1::KeptRequest kept;
        kept.mutable_intervention()->mutable_note()->set_text(std::to_string(rounds_));
        batch.requests.push_back({rounds_, archive::kept_text(kept)});
    }

    archive::Archive& archive_;
    archive::RunId run_;
    std::string words_;
    std::uint64_t seq_ = 0, rounds_ = 0;
};

}  // namespace aeolis::test
