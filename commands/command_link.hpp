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

/// The uplink of one vehicle: telecommand packets out as CLTUs, and what the vehicle's reports (CLCW) say became of
/// them.
///
/// In       packets, each with a tag; CLCWs as Earth receives them; Earth's clock
/// Out      CLTUs to radiate; for each tag, once, what is known of its frame
/// Service  sequence controlled (AD) while the vehicle is heard and both count alike: a frame that is lost is sent
///          again. Else expedited (BD): a frame must not wait for one that nobody can say is missing. Whoever sends may
///          ask for either
/// Faults   a frame that no report confirms is sent again after both light times and `report_s`, `transmissions_max`
///          times at most, then reported as never acknowledged. When the vehicle has locked the channel, as it does
///          after a restart of its computer, or counts otherwise, it is told the sequence anew; what was on its way
///          then is reported, never assumed
class CommandLink {
  public:
    static constexpr double report_s = 25.0;          ///< ours: reports come every 10 s, and may wait for the link
    static constexpr unsigned transmissions_max = 4;  ///< ours

    struct Radiated {
        std::optional<std::uint64_t> tag;  ///< none: a control command to the receiver of frames
        Fop::Service service{};
        std::uint8_t sequence = 0;
        unsigned transmission = 1;
        std::vector<std::uint8_t> cltu;
    };

    explicit CommandLink(double light_time_s);

    /// The service that suits, as above.
    Fop::Service suitable(Ert now) const {
        const bool counts_alike = fop_.state() == Fop::State::active || fop_.state() == Fop::State::retransmitting;
        return hears(now) && counts_alike ? Fop::Service::sequence_controlled : Fop::Service::expedited;
    }

    /// Takes a packet. Fails as Fop::send() does.
    Result<void> send(std::uint64_t tag, std::span<const std::uint8_t> packet, Fop::Service service) {
        return fop_.send(tag, packet, service);
    }

    /// The next unit to be radiated now; none when nothing is to be sent.
    std::optional<Radiated> next(Ert now);

    void hear(const Clcw& clcw, Ert now);
    void pass(Ert now);

    /// Takes out what was never radiated; the tags, in the order in which it would have gone.
    std::vector<std::uint64_t> take_back() { return fop_.take_back(); }
    /// Tags of what was radiated and is not acknowledged.
    std::vector<std::uint64_t> unacknowledged() const { return fop_.unacknowledged(); }
    /// What is not acknowledged is not sent again: it is reported as never acknowledged, and the vehicle is told the
    /// sequence anew.
    void give_up() { fop_.restart(); }

    /// Whether a report came within `report_s`.
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
