// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/packet_model.hpp"
#include "dictionaries/xtce/symbols.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::dictionary::xtce {

/// Reads the parts of types and containers: references, conditions, amounts.
/// Unsupported content is a finding.
class ModelParts {
  public:
    ModelParts(const Symbols& symbols, Reporter& report, const ReadAgreement& agreement);

    struct Reference {
        std::size_t parameter = 0;
        std::string member;            ///< ".flags.valid" for "STATUS/flags/valid"
        const Symbol* type = nullptr;  ///< null: there is none of that name
    };
    std::optional<Reference> parameter(const std::string& scope, pugi::xml_node at, const char* attribute) const;
    /// Reads the children of `parent`: Comparison, ComparisonList, BooleanExpression, or none.
    Condition condition(const std::string& scope, pugi::xml_node parent) const;
    /// Reads the child of `parent`: FixedValue, Fixed, DynamicValue or DiscreteLookupList.
    Amount amount(const std::string& scope, pugi::xml_node parent) const;
    /// Whether the bits and octets of an encoding come the most significant first. Else a finding that says what
    /// becomes of them.
    bool has_usual_order(pugi::xml_node encoding, const std::string& otherwise) const;

    const Symbols& symbols;
    Reporter& report;
    const ReadAgreement agreement;

  private:
    const Symbol* type_at(const Symbol& parameter, std::string_view path) const;
    void compare_with(std::string_view word, const Reference& with, pugi::xml_node at, Condition& condition) const;
    Condition part(const std::string& scope, pugi::xml_node element, unsigned depth) const;
    Condition comparison(const std::string& scope, pugi::xml_node element) const;
    Condition condition_element(const std::string& scope, pugi::xml_node element) const;

    std::map<std::string, std::size_t> parameters_;
};

/// Reads types on demand, since they refer to each other.
class ModelTypes {
  public:
    explicit ModelTypes(const ModelParts& parts) : parts_(parts) {}

    /// Index of the type; index of an unknown type when no type has that name.
    std::size_t of(const std::string& scope, pugi::xml_node at, const char* reference,
                   Kind kind = Kind::parameter_type);
    std::size_t of(const Symbol& symbol);

    std::vector<PacketType> types;

  private:
    PacketType read(const Symbol& symbol);
    void read_coding(const Symbol& symbol, pugi::xml_node holder, PacketType& type);
    void read_number(const Symbol& symbol, pugi::xml_node coding, PacketType& type);
    void read_text(const Symbol& symbol, pugi::xml_node coding, PacketType& type);
    bool read_order(pugi::xml_node coding, std::int64_t bits, Coding& into);
    void check_sign(pugi::xml_node element, const PacketType& type);
    void read_calibrations(const Symbol& symbol, pugi::xml_node coding, Coding& into);
    Calibration calibration(pugi::xml_node calibrator);
    void read_labels(pugi::xml_node element, PacketType& type);
    void read_time(const Symbol& symbol, PacketType& type);
    void read_reference_time(const Symbol& symbol, PacketType& type);
    void read_members(const Symbol& symbol, PacketType& type);
    void read_valid_range(pugi::xml_node element, PacketType& type);
    void read_alarms(const Symbol& symbol, PacketType& type);

    const ModelParts& parts_;
    std::map<std::pair<Kind, std::string>, std::size_t> by_path_;
    unsigned depth_ = 0;
};

std::vector<PacketContainer> read_model_containers(const ModelParts& parts,
                                                   const std::vector<PacketParameter>& parameters,
                                                   const std::vector<PacketType>& types);

/// Reads one alarm: static ranges, labels, numbers of violations and conformances, AncillaryData "latch". What is not
/// judged is a finding.
Alarms read_alarm(pugi::xml_node alarm, const PacketType& type, Reporter& report);

/// The model of documents whose names, and perhaps some types, are known. Takes the types.
PacketModel read_model(const std::string& name, const ModelParts& parts, ModelTypes& types);

/// Reads at most one last index per dimension: from a DimensionList, or as many as the type has.
std::vector<Amount> read_last_indices(const ModelParts& parts, const std::string& scope, pugi::xml_node list);

}  // namespace aeolis::dictionary::xtce
