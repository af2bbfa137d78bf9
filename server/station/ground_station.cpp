#include "server/station/ground_station.hpp"

namespace aeolis::server {

const simulation::CycleReport& GroundStation::receive(const simulation::CycleReport& landed) {
    report_ = landed;
    for (const simulation::ReceivedOctets& piece : landed.octets)
        receive(piece);
    return report_;
}

void GroundStation::receive(const simulation::ReceivedOctets& piece) {
    pltus_.receive(piece.octets);
    while (const auto frame = pltus_.next()) {
        packets_.add(*frame);
        while (const auto packet = packets_.next())
            report_.packets.push_back({piece.link, piece.ert, {packet->begin(), packet->end()}});
    }
}

} // namespace aeolis::server
