// SPDX-License-Identifier: Apache-2.0
#include "telemetry/proof.hpp"

namespace aeolis::telemetry {
namespace {

std::string packets(std::uint64_t count) {
    return std::to_string(count) + (count == 1 ? " packet" : " packets");
}

}  // namespace

Proof prove(const PacketRegister& register_of_run) {
    const PacketRegister::Counts& counts = register_of_run.counts();
    Proof proof;
    proof.recorded = counts.recorded;
    proof.realtime = counts.realtime;
    proof.realtime_not_recorded = counts.realtime - counts.both;
    proof.realtime_differs = counts.differs;
    proof.never_seen_live = counts.recorded - counts.both;
    proof.unregistered = counts.unregistered;
    return proof;
}

std::string text_of(const Proof& proof) {
    std::string text;
    if (proof.holds()) {
        text = "all " + packets(proof.realtime) + " seen in real time are in the recording, bit for bit";
    } else {
        text = "of " + packets(proof.realtime) + " seen in real time, " + std::to_string(proof.realtime_not_recorded) +
               " are not in the recording and " + std::to_string(proof.realtime_differs) + " differ";
        if (proof.unregistered > 0) text += "; " + packets(proof.unregistered) + " could not be compared";
    }
    return text + "; of " + packets(proof.recorded) + " recorded, " + std::to_string(proof.never_seen_live) +
           " were never seen live";
}

}  // namespace aeolis::telemetry
