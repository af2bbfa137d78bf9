// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/fop.hpp"
#include "common/time.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::commands {

/// The uplink of one vehicle: sends telecommand packets as CLTUs and reports their fate from CLCWs.
///
/// In       packets, each with a tag; CLCWs as Earth receives them; Earth's clock
/// Out      CLTUs to radiate; for each tag, once, the fate of its frame
/// Service  sequence controlled (AD) while the vehicle is heard and both ends count alike: a lost frame is sent again.
///          Else expedited (BD), so that no frame waits for one that may not be missing. The caller may choose either
/// Faults   a frame without acknowledgement is sent again after both light times and `report_s`, at most
///          `transmissions_max` times, then reported as never acknowledged. When the vehicle has locked the channel, as
///          after a restart of its computer, or its count differs, the sequence is set anew; frames then under way are
///          reported as unknown, never assumed to have arrived
class CommandLink {
  public:
    static constexpr double report_s = 25.0;  ///< our assumption: reports come every 10 s, and may wait for the link
    static constexpr unsigned transmissions_max = 4;  ///< our assumption

    struct Radiated {
        std::optional<std::uint64_t> tag;  ///< none: a control command to the frame receiver
        Fop::Service service{};
        std::uint8_t sequence = 0;
        unsigned transmission = 1;
        std::vector<std::uint8_t> cltu;
    };

    explicit CommandLink(double light_time_s);

    /// The default service, by the rule above; expedited, too, where the window of unacknowledged frames is full.
    Fop::Service suitable(Ert now) const {
        const bool counts_alike = fop_.state() == Fop::State::active || fop_.state() == Fop::State::retransmitting;
        return hears(now) && counts_alike && fop_.has_window() ? Fop::Service::sequence_controlled
                                                               : Fop::Service::expedited;
    }

    /// Queues a packet. Fails as Fop::send() does.
    Result<void> send(std::uint64_t tag, std::span<const std::uint8_t> packet, Fop::Service service) {
        return fop_.send(tag, packet, service);
    }

    /// The next frame to radiate now; none when there is nothing to send.
    std::optional<Radiated> next(Ert now);

    void hear(const Clcw& clcw, Ert now);
    void pass(Ert now);

    /// Takes back the packets that were never radiated; returns their tags in the order of sending.
    std::vector<std::uint64_t> take_back() { return fop_.take_back(); }
    /// Tags of radiated packets that are not acknowledged.
    std::vector<std::uint64_t> unacknowledged() const { return fop_.unacknowledged(); }
    /// Stops sending unacknowledged frames again: reports them as never acknowledged, and sets the sequence anew.
    void give_up() { fop_.restart(); }

    /// Whether a CLCW was received within the last `report_s`.
    bool hears(Ert now) const;
    std::size_t waiting() const { return fop_.waiting(); }
    const std::optional<Clcw>& last_heard() const { return heard_; }
    std::vector<Fop::Report> take_reports() { return fop_.take_reports(); }

  private:
    Fop fop_;
    double light_time_s_;
    std::optional<Clcw> heard_;
    Ert heard_at_, radiated_at_;
};

/// "sequence-controlled (AD)", "expedited (BD)"
const char* name_of(Fop::Service service);

}  // namespace aeolis::commands
