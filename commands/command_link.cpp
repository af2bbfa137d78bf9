// SPDX-License-Identifier: Apache-2.0
#include "commands/command_link.hpp"

#include "common/check.hpp"
#include "common/cltu.hpp"
#include "common/ids.hpp"

namespace aeolis::commands {
namespace {

double seconds_between(Ert earlier, Ert later) {
    return static_cast<double>(later.microseconds - earlier.microseconds) * 1.0e-6;
}

}  // namespace

const char* name_of(Fop::Service service) {
    return service == Fop::Service::sequence_controlled ? "sequence-controlled (AD)" : "expedited (BD)";
}

CommandLink::CommandLink(double light_time_s)
    : fop_({.spacecraft = spacecraft_id,
            .virtual_channel = telecommand_channel,
            .window = 32,
            .transmissions_max = transmissions_max}),
      light_time_s_(light_time_s) {}

bool CommandLink::hears(Ert now) const {
    return heard_ && seconds_between(heard_at_, now) <= report_s;
}

std::optional<CommandLink::Radiated> CommandLink::next(Ert now) {
    auto outgoing = fop_.next();
    if (!outgoing) return std::nullopt;
    radiated_at_ = now;
    const auto frame = read_tc_frame(outgoing->frame);
    AEOLIS_CHECK(static_cast<bool>(frame));
    Radiated radiated{outgoing->tag,
                      frame->header.bypass ? Fop::Service::expedited : Fop::Service::sequence_controlled,
                      frame->header.sequence,
                      outgoing->transmission,
                      {}};
    radiated.cltu.resize(cltu_octets(outgoing->frame.size()));
    write_cltu(outgoing->frame, radiated.cltu);
    return radiated;
}

void CommandLink::hear(const Clcw& clcw, Ert now) {
    if (clcw.virtual_channel != telecommand_channel) return;
    heard_ = clcw;
    heard_at_ = now;
    fop_.on(clcw);
    if (fop_.state() == Fop::State::halted) fop_.restart();
}

void CommandLink::pass(Ert now) {
    const bool unanswered = fop_.outstanding() > 0 || fop_.state() == Fop::State::restarting;
    if (unanswered && seconds_between(radiated_at_, now) > report_s + 2.0 * light_time_s_) {
        fop_.repeat();
        radiated_at_ = now;
    }
}

}  // namespace aeolis::commands
