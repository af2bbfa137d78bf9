#include "server/archive/records.hpp"

namespace aeolis::archive {

const char* name_of(Link link) {
    switch (link) {
    case Link::uhf_live:
        return "uhf_live";
    case Link::relay:
        return "relay";
    case Link::x_band:
        return "x_band";
    }
    return "unknown";
}

void Batch::clear() {
    first_seq = last_seq = 0;
    octets.clear();
    values.clear();
    units.clear();
    samples.clear();
    events.clear();
    tones.clear();
    stages.clear();
    firings.clear();
    explanations.clear();
    links.clear();
    alarms.clear();
    segments.clear();
    totals.reset();
    end.reset();
}

} // namespace aeolis::archive
