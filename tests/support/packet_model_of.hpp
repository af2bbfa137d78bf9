// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/space_packet.hpp"
#include "dictionaries/dictionary.hpp"
#include "dictionaries/xtce/packet_model.hpp"

#include <map>
#include <memory>
#include <string>

namespace aeolis::tests {

/// The containers of a dictionary that a test has made by hand, as its XTCE file would have them.
class PacketModelMaker {
  public:
    static std::shared_ptr<const dictionary::xtce::PacketModel> make(const dictionary::Dictionary& dictionary) {
        PacketModelMaker maker;
        maker.add_root();
        for (const auto& packet : dictionary.packets) maker.add(packet);
        return std::make_shared<const dictionary::xtce::PacketModel>(std::move(maker.model_));
    }

  private:
    using Model = dictionary::xtce::PacketModel;
    using Container = dictionary::xtce::PacketContainer;
    using Condition = dictionary::xtce::Condition;
    using PacketType = dictionary::xtce::PacketType;
    using Coding = dictionary::xtce::Coding;
    using Entry = dictionary::xtce::PacketEntry;

    static dictionary::Type whole(unsigned bits) {
        dictionary::Type type;
        type.bits = bits;
        return type;
    }
    static Coding::Form form_of(dictionary::Encoding encoding) {
        switch (encoding) {
        case dictionary::Encoding::unsigned_integer: return Coding::Form::unsigned_integer;
        case dictionary::Encoding::twos_complement: return Coding::Form::twos_complement;
        case dictionary::Encoding::ieee754: break;
        }
        return Coding::Form::ieee754;
    }
    static PacketType::Kind kind_of(dictionary::ValueKind kind) {
        switch (kind) {
        case dictionary::ValueKind::integer: return PacketType::Kind::integer;
        case dictionary::ValueKind::real: return PacketType::Kind::real;
        case dictionary::ValueKind::enumerated: return PacketType::Kind::enumerated;
        case dictionary::ValueKind::boolean: return PacketType::Kind::boolean;
        case dictionary::ValueKind::text: break;
        }
        return PacketType::Kind::text;
    }

    std::size_t parameter(const std::string& name, const dictionary::Type& type, Condition valid = {}) {
        PacketType made;
        made.name = type.name;
        made.kind = kind_of(type.kind);
        made.coding.form = form_of(type.encoding);
        made.coding.bits = dictionary::xtce::Amount::fixed(type.bits);
        made.coding.calibration.polynomial = type.calibrator;
        for (const auto& entry : type.enumeration)
            made.labels.push_back({entry.value, entry.last.value_or(entry.value), entry.label});
        model_.types.push_back(std::move(made));
        model_.parameters.push_back({name, {}, model_.types.size() - 1, std::move(valid), 0});
        return model_.parameters.size() - 1;
    }
    static Entry at(std::size_t parameter, unsigned position_bits) {
        Entry entry;
        entry.what = Entry::What::parameter;
        entry.index = parameter;
        entry.from = Entry::From::container_start;
        entry.offset_bits = dictionary::xtce::Amount::fixed(position_bits);
        return entry;
    }
    static Condition is(std::size_t parameter, unsigned value) {
        Condition condition;
        condition.form = Condition::Form::compare;
        condition.parameter = parameter;
        condition.calibrated = false;
        condition.value = std::to_string(value);
        return condition;
    }

    void add_root() {
        model_.root = 0;
        Container root{.name = "TmPacket", .path = "/TmPacket", .abstract = true};
        apid_ = parameter("apid", whole(11));
        root.entries = {at(apid_, 5), at(parameter("dictionary_id", whole(16)), tm_data_offset_octets * 8 - 16)};
        model_.containers.push_back(std::move(root));
    }
    std::size_t events_of(Apid apid) {
        const auto [events, added] = events_.try_emplace(apid, model_.containers.size());
        if (!added) return events->second;
        Container container{
            .name = "Event", .path = "/Event", .abstract = true, .base = 0, .when = is(apid_, apid.value)};
        if (!event_id_) event_id_ = parameter("event_id", whole(16));
        container.entries = {at(*event_id_, tm_data_offset_octets * 8)};
        model_.containers.push_back(std::move(container));
        return events->second;
    }
    void add(const dictionary::Packet& packet) {
        const std::size_t base = packet.event ? events_of(packet.apid) : 0;
        Container container{.name = packet.name, .path = "/" + packet.name, .base = base};
        container.when = packet.event ? is(*event_id_, packet.event->value) : is(apid_, packet.apid.value);
        for (const auto& field : packet.fields) {
            if (packet.event && field.name == "event_id") continue;
            Condition valid;
            if (field.validity_bit) {
                const std::size_t flag = parameter(field.name + "_defined", whole(1));
                container.entries.push_back(at(flag, *field.validity_bit));
                valid = is(flag, 1);
            }
            container.entries.push_back(at(parameter(field.name, field.type, std::move(valid)), field.position_bits));
        }
        model_.containers.push_back(std::move(container));
    }

    Model model_;
    std::size_t apid_ = 0;
    std::optional<std::size_t> event_id_;
    std::map<Apid, std::size_t> events_;
};

inline std::shared_ptr<const dictionary::xtce::PacketModel> packet_model_of(const dictionary::Dictionary& dictionary) {
    return PacketModelMaker::make(dictionary);
}

}  // namespace aeolis::tests
