// SPDX-License-Identifier: Apache-2.0
#include "server/archive/records.hpp"

#include "server/archive/item_tables.hpp"

#include <utility>

namespace aeolis::archive {

void Extremes::add(const Extremes& later) {
    if (later.defined == 0) return;
    if (defined == 0 || later.least < least) {
        least = later.least;
        least_sclk_s = later.least_sclk_s;
    }
    if (defined == 0 || later.largest > largest) {
        largest = later.largest;
        largest_sclk_s = later.largest_sclk_s;
    }
    defined += later.defined;
}

void Batch::add(Annotation annotation) {
    if (auto* note = std::get_if<NoteRecord>(&annotation))
        notes.push_back(std::move(*note));
    else
        alarm_actions.push_back(std::move(std::get<AlarmActionRecord>(annotation)));
}

void Batch::clear() {
    first_seq = last_seq = 0;
    octets.clear();
    values.clear();
    samples.clear();
    for_item_kinds([this]<typename Record>(ItemKind<Record>) { (this->*ItemTable<Record>::of_batch).clear(); });
    segments.clear();
    requests.clear();
    pyramid.clear();
    totals.reset();
    link_totals.clear();
    raw.clear();
    raw_octets = 0;
    end.reset();
}

}  // namespace aeolis::archive
