#include "server/archive/records.hpp"

namespace aeolis::archive {

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
    requests.clear();
    totals.reset();
    link_totals.clear();
    end.reset();
}

} // namespace aeolis::archive
