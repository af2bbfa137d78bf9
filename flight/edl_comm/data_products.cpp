// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_comm/data_products.hpp"

#include "common/crc.hpp"
#include "flight/edl_comm/sensor_tables.hpp"

#include <algorithm>
#include <utility>

namespace aeolis::flight {
namespace {

constexpr std::size_t part_octets = std::tuple_size_v<decltype(packet::DataProduct::content)>;

Apid row_apid(ProductKind kind) {
    switch (kind) {
    case ProductKind::as_flown: return packet::TimepointFired::apid;
    case ProductKind::imu_burst: return packet::ImuIncrements::apid;
    case ProductKind::parameter_table: return packet::ParameterRow::apid;
    }
    return {};
}

}  // namespace

void AsFlown::on(const Record& firing) {
    if (firing.size != row_octets || content_.size() + row_octets > content_.capacity()) return;
    content_.append(std::span{firing.data}.first(row_octets));
}

void ImuBurst::on(const ImuReadings& readings) {
    for (const ImuSample& sample : readings.samples) {
        if (!begun_)
            before_[heard_++ % rows_before] = sample;
        else if (!complete())
            append(sample);
    }
}

void ImuBurst::begin() {
    if (std::exchange(begun_, true)) return;
    kept_ = static_cast<std::size_t>(std::min<std::uint64_t>(heard_, rows_before));
    for (std::uint64_t row = heard_ - kept_; row < heard_; ++row) append(before_[row % rows_before]);
}

void ImuBurst::append(const ImuSample& sample) {
    std::array<std::uint8_t, row_octets> row{};
    BitWriter writer{row};
    row_of(sample).encode(writer);
    rows_.append(row);
}

void DataProducts::on(const Record& record) {
    if (record.apid != packet::TimepointFired::apid) return;
    as_flown_.on(record);
    // After the last firing the product is complete. It is delivered with the recording.
    if (read_bits(record.data, 0, 16) + 1 != timepoint_count) return;
    timeline_complete_ = true;
    static_cast<void>(due_.try_push(ProductKind::as_flown));
}

void DataProducts::on(const ImuReadings& readings) {
    imu_burst_.on(readings);
}

void DataProducts::on(const PhaseChanged& change) {
    // Only a computer that flew the entry saw the mortar fire; one that takes over under the parachute did not.
    const bool in_entry = phase_ >= EdlPhase::range_control && phase_ < EdlPhase::parachute_descent;
    if (in_entry && change.phase == EdlPhase::parachute_descent) imu_burst_.begin();
    phase_ = change.phase;
    // While UHF has some seconds left: the firings up to touchdown.
    if (change.phase == EdlPhase::landed) static_cast<void>(due_.try_push(ProductKind::as_flown));
}

void DataProducts::on(const ParameterPart& part) {
    if (!table_.on(part)) return;
    table_rows_ = rows_of(table_.values());
    if (sending_ && sending_->part.product_kind == ProductKind::parameter_table) sending_.reset();
    if (!table_due_) table_due_ = due_.try_push(ProductKind::parameter_table);
}

std::span<const std::uint8_t> DataProducts::content(ProductKind kind) const {
    switch (kind) {
    case ProductKind::as_flown: return as_flown_.content();
    case ProductKind::imu_burst: return imu_burst_.content();
    case ProductKind::parameter_table: return table_rows_;
    }
    return {};
}

void DataProducts::begin_next() {
    if (imu_burst_.complete() && !imu_burst_due_) imu_burst_due_ = due_.try_push(ProductKind::imu_burst);
    while (!sending_ && !due_.empty()) {
        const ProductKind kind = due_.front();
        due_.pop();
        if (kind == ProductKind::parameter_table) table_due_ = false;
        const auto octets = content(kind);
        if (octets.empty()) continue;
        const std::size_t parts = (octets.size() + part_octets - 1) / part_octets;
        sending_ = Sending{{.product_kind = kind,
                            .product_id = ++made_,
                            .row_apid = row_apid(kind).value,
                            .part = 0,
                            .parts = static_cast<std::uint16_t>(parts),
                            .product_octets = static_cast<std::uint32_t>(octets.size()),
                            .product_crc = crc16(octets),
                            .content = {}},
                           octets.size()};
    }
}

void DataProducts::cycle(Outbox& out) {
    if (!sending_) begin_next();
    if (!sending_) return;
    auto& part = sending_->part;
    const std::size_t begin = part.part * part_octets;
    const std::size_t size = std::min(part_octets, sending_->octets - begin);
    part.content.fill(0);
    // Rows are only ever appended, and a new table begins a new product: the content is that at its start.
    std::ranges::copy(content(part.product_kind).subspan(begin, size), part.content.begin());
    ++part.part;
    out.record(part);
    if (part.part == part.parts) sending_.reset();
}

}  // namespace aeolis::flight
