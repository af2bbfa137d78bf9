// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/packet_model_reader.hpp"

#include <cmath>
#include <string_view>

namespace aeolis::dictionary::xtce {
namespace {

class ContainerReader {
  public:
    ContainerReader(const ModelParts& parts, const std::vector<PacketParameter>& parameters,
                    const std::vector<PacketType>& types)
        : parts_(parts), parameters_(parameters), types_(types) {
        for (const Symbol& symbol : parts.symbols.all())
            if (symbol.kind == Kind::container) containers_.emplace(symbol.path, containers_.size());
    }

    PacketContainer read(const Symbol& symbol) {
        const pugi::xml_node element = symbol.element;
        PacketContainer container{.name = name_of(element),
                                  .path = symbol.path,
                                  .line = parts_.report.line(element),
                                  .abstract = parts_.report.flag_or(element, "abstract", false).value_or(true)};
        if (const pugi::xml_node base = element.child("BaseContainer")) {
            container.base = index_of(symbol, base);
            container.when = parts_.condition(symbol.scope, base.child("RestrictionCriteria"));
            // Without its base, a container would be mistaken for a packet of its own.
            if (!container.base) container.when.form = Condition::Form::unknown;
        }
        if (const pugi::xml_node size = element.child("BinaryEncoding").child("SizeInBits"))
            container.bits = parts_.amount(symbol.scope, size);
        if (is_transformed(element.child("BinaryEncoding")))
            container.entries.push_back({.what = PacketEntry::What::unknown, .line = container.line});
        if (const pugi::xml_node rate = element.child("DefaultRateInStream"))
            container.expected_rate_hz = read_rate(rate);
        if (const pugi::xml_node rates = element.child("RateInStreamSet"))
            parts_.report.fault(rates, "RateInStreamSet is not read: the rate is that of DefaultRateInStream");
        for (const pugi::xml_node entry : element.child("EntryList").children())
            if (entry.type() == pugi::node_element) container.entries.push_back(read_entry(symbol, entry));
        return container;
    }

  private:
    /// Whether a container's octets are others before they are read.
    bool is_transformed(pugi::xml_node encoding) {
        const pugi::xml_node algorithm = encoding.child("FromBinaryTransformAlgorithm");
        if (algorithm)
            parts_.report.fault(algorithm, "FromBinaryTransformAlgorithm is not supported: packets are read up to it");
        return !parts_.has_usual_order(encoding, "packets are read up to it") || algorithm;
    }
    /// A greatest rate alone promises nothing.
    std::optional<double> read_rate(pugi::xml_node rate) {
        const std::string_view basis = rate.attribute("basis").as_string("perSecond");
        if (basis != "perSecond") {
            parts_.report.fault(rate, "a rate " + in_quotes(basis) + " is not read: only perSecond is");
            return std::nullopt;
        }
        const auto least_hz = parts_.report.number(rate, "minimumValue");
        const auto most_hz = parts_.report.number(rate, "maximumValue");
        const bool usable = (!least_hz || (std::isfinite(*least_hz) && *least_hz >= 0.0)) &&
                            (!least_hz || !most_hz || *least_hz <= *most_hz);
        if (!usable) parts_.report.fault(rate, "its rate is no rate, and is not used");
        return usable && least_hz && *least_hz > 0.0 ? least_hz : std::nullopt;
    }

    std::optional<std::size_t> index_of(const Symbol& from, pugi::xml_node at) {
        const std::string word = at.attribute("containerRef").value();
        const Symbol* symbol = parts_.symbols.find(Kind::container, from.scope, word);
        if (symbol != nullptr) return containers_.at(symbol->path);
        parts_.report.fault(at, "there is no container " + in_quotes(word));
        return std::nullopt;
    }

    PacketEntry read_entry(const Symbol& symbol, pugi::xml_node element) {
        PacketEntry entry;
        entry.line = parts_.report.line(element);
        const std::string_view name = element.name();
        std::optional<std::size_t> index;
        if (name == "ParameterRefEntry" || name == "ArrayParameterRefEntry") {
            const auto found = parts_.parameter(symbol.scope, element, "parameterRef");
            if (found && found->member.empty()) index = found->parameter;
            if (found && !found->member.empty())
                parts_.report.fault(element, "an entry for a member alone is not supported: packets are read up to it");
            entry.what = PacketEntry::What::parameter;
            entry.last_indices = read_last_indices(parts_, symbol.scope, element.child("DimensionList"));
            if (index) check(element, types_[parameters_[*index].type], entry.last_indices.empty());
        } else if (name == "ContainerRefEntry") {
            index = index_of(symbol, element);
            entry.what = PacketEntry::What::container;
        } else {
            parts_.report.fault(element, std::string{name} + " is not supported: packets are read up to it");
        }
        if (!index)
            entry.what = PacketEntry::What::unknown;
        else
            entry.index = *index;
        read_location(symbol, element, entry);
        if (const pugi::xml_node include = element.child("IncludeCondition"))
            entry.when = parts_.condition(symbol.scope, include);
        if (const pugi::xml_node time = element.child("TimeAssociation"))
            parts_.report.fault(time, "TimeAssociation is not read: the entry has the time of its packet");
        if (const pugi::xml_node repeat = element.child("RepeatEntry")) {
            entry.count = parts_.amount(symbol.scope, repeat.child("Count"));
            if (const pugi::xml_node offset = repeat.child("Offset"))
                entry.gap_bits = parts_.amount(symbol.scope, offset);
        }
        return entry;
    }

    /// Names what a type lacks that only matters in a packet.
    void check(pugi::xml_node element, const PacketType& type, bool is_sized_by_type) {
        if (type.kind == PacketType::Kind::array && is_sized_by_type && type.last_indices.empty())
            parts_.report.fault(element, "the dimensions of the array are told nowhere: packets are read up to it");
        std::vector<bool> seen(types_.size(), false);  // a type may hold itself
        if (const PacketType* found = uncoded(type, seen))
            parts_.report.fault(element,
                                "type " + in_quotes(found->name) + " has no data encoding: packets are read up to it");
    }
    const PacketType* uncoded(const PacketType& type, std::vector<bool>& seen) const {
        const auto within = [&](std::size_t part) -> const PacketType* {
            if (seen[part]) return nullptr;
            seen[part] = true;
            return uncoded(types_[part], seen);
        };
        if (type.kind == PacketType::Kind::array) return within(type.element);
        for (const auto& member : type.members)
            if (const PacketType* found = within(member.type)) return found;
        return type.uncoded ? &type : nullptr;
    }

    void read_location(const Symbol& symbol, pugi::xml_node element, PacketEntry& entry) {
        const pugi::xml_node location = element.child("LocationInContainerInBits");
        if (!location) return;
        const std::string_view from = location.attribute("referenceLocation").as_string("previousEntry");
        if (from == "containerStart") {
            entry.from = PacketEntry::From::container_start;
        } else if (from != "previousEntry") {
            parts_.report.fault(location,
                                "a location from " + in_quotes(from) + " is not supported: packets are read up to it");
            entry.what = PacketEntry::What::unknown;
        }
        entry.offset_bits = parts_.amount(symbol.scope, location);
    }

    const ModelParts& parts_;
    const std::vector<PacketParameter>& parameters_;
    const std::vector<PacketType>& types_;
    std::map<std::string, std::size_t> containers_;
};

/// Breaks what would never end: containers that hold or derive from themselves, directly or through others.
class CycleBreaker {
  public:
    CycleBreaker(const ModelParts& parts, std::vector<PacketContainer>& containers)
        : containers_(containers), states_(containers.size()) {
        for (const Symbol& symbol : parts.symbols.all())
            if (symbol.kind == Kind::container) elements_.push_back(symbol.element);
        for (std::size_t i = 0; i < containers.size(); ++i)
            if (states_[i] == State::unseen) visit(i, parts.report);
    }

  private:
    enum class State : std::uint8_t { unseen, open, done };
    /// A container and which of its base (0) and entries (from 1 on) is next.
    struct Visit {
        std::size_t container = 0, next = 0;
    };

    void visit(std::size_t from, Reporter& report) {
        std::vector<Visit> path{{from, 0}};
        states_[from] = State::open;
        while (!path.empty()) {
            const std::size_t at = path.back().container, part = path.back().next++;
            PacketContainer& container = containers_[at];
            if (part > container.entries.size()) {
                states_[at] = State::done;
                path.pop_back();
                continue;
            }
            const auto to = part == 0 ? container.base : included(container.entries[part - 1]);
            if (!to || states_[*to] == State::done) continue;
            if (states_[*to] == State::unseen) {
                states_[*to] = State::open;
                path.push_back({*to, 0});
            } else if (part == 0) {
                report.fault(elements_[at], "container " + in_quotes(container.name) + " derives from itself, by " +
                                                in_quotes(containers_[*to].name) + ": it takes no packet");
                container.base.reset();
                container.when.form = Condition::Form::unknown;
            } else {
                report.fault(elements_[at], "container " + in_quotes(container.name) + " holds itself, by " +
                                                in_quotes(containers_[*to].name) + ": packets are read up to it");
                container.entries[part - 1].what = PacketEntry::What::around;
            }
        }
    }
    static std::optional<std::size_t> included(const PacketEntry& entry) {
        return entry.what == PacketEntry::What::container ? std::optional{entry.index} : std::nullopt;
    }

    std::vector<PacketContainer>& containers_;
    std::vector<State> states_;
    std::vector<pugi::xml_node> elements_;
};

}  // namespace

std::vector<PacketContainer> read_model_containers(const ModelParts& parts,
                                                   const std::vector<PacketParameter>& parameters,
                                                   const std::vector<PacketType>& types) {
    ContainerReader reader{parts, parameters, types};
    std::vector<PacketContainer> containers;
    for (const Symbol& symbol : parts.symbols.all())
        if (symbol.kind == Kind::container) containers.push_back(reader.read(symbol));
    const CycleBreaker broken{parts, containers};
    return containers;
}

}  // namespace aeolis::dictionary::xtce
