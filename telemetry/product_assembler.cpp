// SPDX-License-Identifier: Apache-2.0
#include "telemetry/product_assembler.hpp"

#include "common/crc.hpp"
#include "common/space_packet.hpp"
#include "telemetry/text.hpp"

#include <algorithm>

namespace aeolis::telemetry {
namespace {

constexpr std::size_t part_cost_octets =
    64;  // approximate cost of keeping a part: its vector and its place; our assumption

}  // namespace

std::optional<ProductPart> part_of(const dictionary::Dictionary& dictionary, const Decoded& decoded,
                                   std::span<const std::uint8_t> packet) {
    const dictionary::Packet& container = dictionary.packets[decoded.packet];
    if (container.name != "DataProduct" || !container.content || packet.size() != container.octets) return std::nullopt;
    const auto number = [&](std::string_view name) -> std::uint64_t {
        const auto field = field_index(container, name);
        return field ? decoded.raw[*field] : 0;
    };
    const std::uint64_t octets = number("product_octets");
    const std::uint64_t part = number("part");
    const std::uint64_t parts = number("parts");
    const std::uint64_t part_octets = container.content->octets;
    if (octets == 0 || part < 1 || part > parts || parts != (octets + part_octets - 1) / part_octets)
        return std::nullopt;

    ProductPart read;
    read.product = {static_cast<std::uint16_t>(number("product_id")), static_cast<std::uint16_t>(number("product_crc")),
                    static_cast<std::uint32_t>(octets)};
    if (const auto kind = field_index(container, "product_kind"))
        read.kind = number_text(container.fields[*kind].type, decoded.value[*kind]);
    read.row_apid = Apid{static_cast<std::uint16_t>(number("row_apid"))};
    read.part = static_cast<std::uint16_t>(part);
    read.parts = static_cast<std::uint16_t>(parts);
    const auto content =
        packet.subspan(container.content->offset_octets, std::min(part_octets, octets - (part - 1) * part_octets));
    read.content.assign(content.begin(), content.end());
    return read;
}

std::optional<std::vector<std::uint8_t>> Product::content(const ProductIdentity& identity) const {
    std::vector<std::uint8_t> all;
    for (const auto& part : received) {
        if (!part) return std::nullopt;
        all.insert(all.end(), part->begin(), part->end());
    }
    if (all.size() != identity.octets || crc16(all) != identity.crc) return std::nullopt;
    return all;
}

std::string Product::gaps() const {
    std::string text;
    for (std::size_t first = 0; first < received.size(); ++first) {
        if (received[first]) continue;
        std::size_t last = first;
        while (last + 1 < received.size() && !received[last + 1]) ++last;
        text += (text.empty() ? "" : ", ") + std::to_string(first + 1);
        if (last > first) text += "-" + std::to_string(last + 1);
        first = last;
    }
    return text;
}

PartStanding ProductAssembler::add(const ProductPart& part) {
    auto known = products_.find(part.product);
    const std::size_t cost =
        part.content.size() + (known == products_.end() ? std::size_t{part.parts} * part_cost_octets : 0);
    if (known == products_.end()) {
        if (octets_ + cost > octets_max_) return PartStanding::refused;
        known = products_.emplace(part.product, Product{part.kind, part.row_apid, part.parts, {}}).first;
        known->second.received.resize(part.parts);
    }
    Product& product = known->second;
    if (product.kind != part.kind || product.row_apid != part.row_apid || product.parts != part.parts)
        return PartStanding::differs;
    auto& place = product.received.at(part.part - std::size_t{1});
    if (place) return *place == part.content ? PartStanding::again : PartStanding::differs;
    if (octets_ + cost > octets_max_) return PartStanding::refused;
    octets_ += cost;
    place = part.content;
    return PartStanding::taken;
}

std::string text_of(const ProductIdentity& identity, const Product& product) {
    std::string text =
        product.kind + " " + std::to_string(identity.id) + ", " + std::to_string(identity.octets) + " octets: ";
    if (const std::string gaps = product.gaps(); !gaps.empty())
        return text + "parts " + gaps + " of " + std::to_string(product.parts) + " are missing";
    return text + (product.content(identity) ? "whole" : "all parts are here, but their CRC is wrong");
}

std::optional<std::vector<std::vector<std::uint8_t>>> rows_of(const dictionary::Dictionary& dictionary, Apid row_apid,
                                                              std::span<const std::uint8_t> content) {
    const auto container = std::ranges::find(dictionary.packets, row_apid, &dictionary::Packet::apid);
    if (container == dictionary.packets.end() || container->event || container->octets <= tm_overhead_octets)
        return std::nullopt;
    const std::size_t row_octets = container->octets - tm_overhead_octets;
    if (content.size() % row_octets != 0) return std::nullopt;
    std::vector<std::vector<std::uint8_t>> rows;
    rows.reserve(content.size() / row_octets);
    for (; !content.empty(); content = content.subspan(row_octets)) {
        std::vector<std::uint8_t> packet(container->octets);
        std::ranges::copy(content.first(row_octets), packet.begin() + tm_data_offset_octets);
        seal_tm_packet(packet, row_apid, 0, {}, dictionary.id);
        rows.push_back(std::move(packet));
    }
    return rows;
}

std::optional<std::vector<std::vector<std::uint8_t>>>
rows_in(const dictionary::Dictionary& dictionary, const Decoded& decoded, std::span<const std::uint8_t> packet) {
    const dictionary::Packet& table = dictionary.packets[decoded.packet];
    const auto row_apid = field_index(table, "row_apid"), rows = field_index(table, "table_rows");
    if (!row_apid || !rows || !table.content || packet.size() != table.octets) return std::nullopt;
    const Apid apid{static_cast<std::uint16_t>(decoded.raw[*row_apid])};
    const auto container = std::ranges::find(dictionary.packets, apid, &dictionary::Packet::apid);
    if (container == dictionary.packets.end() || container->octets <= tm_overhead_octets) return std::nullopt;
    const std::size_t octets = decoded.raw[*rows] * (container->octets - tm_overhead_octets);
    if (octets > table.content->octets) return std::nullopt;
    return rows_of(dictionary, apid, packet.subspan(table.content->offset_octets, octets));
}

}  // namespace aeolis::telemetry
