// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/packet_grammar.hpp"

#include "dictionaries/words.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace aeolis::dictionary::xtce {
namespace {

/// An element, alone or behind its parent and a slash, and what it may have. "name!" is in the standard and not read,
/// "name!value" is not read unless it is that value. "*": its reader reports unknown children.
struct GrammarRow {
    std::string_view element, children, attributes;
};

constexpr std::string_view range_ends = "minInclusive maxInclusive minExclusive maxExclusive rangeForm";
constexpr std::string_view alarm_words =
    "minConformance minViolations name shortDescription disabled defaultAlarmLevel!normal";

constexpr auto grammar_rows = std::to_array<GrammarRow>({
    // Types
    {"ParameterTypeSet", "*", ""},
    {"IntegerParameterType",
     "AliasSet AncillaryDataSet BinaryDataEncoding ContextAlarmList DefaultAlarm FloatDataEncoding IntegerDataEncoding "
     "LongDescription StringDataEncoding ToString UnitSet ValidRange ValidRangeSet",
     "baseType initialValue name shortDescription signed sizeInBits"},
    {"FloatParameterType",
     "AliasSet AncillaryDataSet BinaryDataEncoding ContextAlarmList DefaultAlarm FloatDataEncoding IntegerDataEncoding "
     "LongDescription StringDataEncoding ToString UnitSet ValidRange ValidRangeSet",
     "baseType initialValue name shortDescription sizeInBits"},
    {"EnumeratedParameterType",
     "AliasSet AncillaryDataSet BinaryDataEncoding ContextAlarmList DefaultAlarm EnumerationList FloatDataEncoding "
     "IntegerDataEncoding LongDescription StringDataEncoding UnitSet",
     "baseType initialValue name shortDescription"},
    {"BooleanParameterType",
     "AliasSet AncillaryDataSet BinaryDataEncoding ContextAlarmList DefaultAlarm FloatDataEncoding IntegerDataEncoding "
     "LongDescription StringDataEncoding UnitSet",
     "baseType initialValue name oneStringValue shortDescription zeroStringValue"},
    {"StringParameterType",
     "AliasSet AncillaryDataSet BinaryDataEncoding ContextAlarmList DefaultAlarm FloatDataEncoding IntegerDataEncoding "
     "LongDescription SizeRangeInCharacters StringDataEncoding UnitSet",
     "baseType characterWidth initialValue name restrictionPattern shortDescription"},
    {"BinaryParameterType",
     "AliasSet AncillaryDataSet BinaryContextAlarmList! BinaryDataEncoding ContextAlarmList DefaultAlarm "
     "FloatDataEncoding IntegerDataEncoding LongDescription StringDataEncoding UnitSet",
     "baseType initialValue name shortDescription"},
    {"AbsoluteTimeParameterType", "AliasSet AncillaryDataSet Encoding LongDescription ReferenceTime UnitSet",
     "baseType initialValue name shortDescription"},
    {"RelativeTimeParameterType",
     "AliasSet AncillaryDataSet ContextAlarmList! DefaultAlarm! Encoding LongDescription ReferenceTime UnitSet",
     "baseType initialValue name shortDescription"},
    {"AggregateParameterType", "AliasSet AncillaryDataSet LongDescription MemberList UnitSet",
     "initialValue name shortDescription"},
    {"ArrayParameterType", "AliasSet AncillaryDataSet DimensionList LongDescription UnitSet",
     "arrayTypeRef initialValue name numberOfDimensions shortDescription"},
    {"MemberList", "Member", ""},
    {"Member", "AliasSet AncillaryDataSet LongDescription",
     "initialValue name parameterTypeRef shortDescription typeRef"},
    {"UnitSet", "Unit", ""},
    {"Unit", "", "description factor!1 form power!1"},
    {"EnumerationList", "Enumeration", ""},
    {"Enumeration", "", "label maxValue shortDescription value"},
    {"ValidRangeSet", "ValidRange", "validRangeAppliesToCalibrated!true"},
    {"ValidRange", "", "maxExclusive! maxInclusive minExclusive! minInclusive validRangeAppliesToCalibrated!true"},
    // Encodings
    {"Encoding", "BinaryDataEncoding FloatDataEncoding IntegerDataEncoding StringDataEncoding", "offset scale units"},
    {"ReferenceTime", "Epoch OffsetFrom", ""},
    {"Epoch", "", ""},
    {"OffsetFrom", "", "instance parameterRef useCalibratedValue"},
    {"IntegerDataEncoding", "ByteOrderList ContextCalibratorList DefaultCalibrator ErrorDetectCorrect! UnitSet",
     "bitOrder byteOrder changeThreshold encoding sizeInBits"},
    {"FloatDataEncoding", "ByteOrderList ContextCalibratorList DefaultCalibrator ErrorDetectCorrect! UnitSet",
     "bitOrder byteOrder changeThreshold encoding sizeInBits"},
    {"StringDataEncoding", "ByteOrderList! ErrorDetectCorrect! SizeInBits UnitSet Variable",
     "bitOrder byteOrder encoding"},
    {"BinaryDataEncoding",
     "ByteOrderList! ErrorDetectCorrect! FromBinaryTransformAlgorithm SizeInBits ToBinaryTransformAlgorithm UnitSet",
     "bitOrder byteOrder"},
    {"ByteOrderList", "Byte", ""},
    {"Byte", "", "byteSignificance"},
    {"StringDataEncoding/SizeInBits", "DiscreteLookupList DynamicValue Fixed FixedValue LeadingSize TerminationChar",
     ""},
    {"Variable", "DiscreteLookupList DynamicValue LeadingSize TerminationChar", "maxSizeInBits"},
    {"LeadingSize", "", "sizeInBitsOfSizeTag"},
    {"TerminationChar", "", ""},
    {"DefaultCalibrator", "AncillaryDataSet MathOperationCalibrator PolynomialCalibrator SplineCalibrator",
     "name shortDescription"},
    {"Calibrator", "AncillaryDataSet MathOperationCalibrator PolynomialCalibrator SplineCalibrator",
     "name shortDescription"},
    {"ContextCalibratorList", "ContextCalibrator", ""},
    {"ContextCalibrator", "Calibrator ContextMatch", ""},
    {"PolynomialCalibrator", "AncillaryDataSet Term", "name shortDescription"},
    {"Term", "", "coefficient exponent"},
    {"SplineCalibrator", "AncillaryDataSet SplinePoint", "extrapolate name order shortDescription"},
    {"SplinePoint", "", "calibrated order raw"},
    // Amounts
    {"SizeInBits", "DiscreteLookupList DynamicValue Fixed FixedValue", ""},
    {"Count", "DiscreteLookupList DynamicValue FixedValue", ""},
    {"Offset", "DiscreteLookupList DynamicValue FixedValue", ""},
    {"StartingIndex", "DiscreteLookupList DynamicValue FixedValue", ""},
    {"EndingIndex", "DiscreteLookupList DynamicValue FixedValue", ""},
    {"Fixed", "FixedValue", ""},
    {"FixedValue", "", ""},
    {"DynamicValue", "LinearAdjustment ParameterInstanceRef", ""},
    {"LinearAdjustment", "", "intercept slope"},
    {"DiscreteLookupList", "DiscreteLookup", "defaultValue"},
    {"DiscreteLookup", "*", "value"},
    {"DimensionList", "Dimension", ""},
    {"Dimension", "EndingIndex StartingIndex", ""},
    // Conditions
    {"RestrictionCriteria", "*", ""},
    {"IncludeCondition", "*", ""},
    {"ValidityCondition", "*", ""},
    {"ContextMatch", "*", ""},
    {"ComparisonList", "*", ""},
    {"BooleanExpression", "*", ""},
    {"ANDedConditions", "*", ""},
    {"ORedConditions", "*", ""},
    {"Comparison", "", "comparisonOperator instance parameterRef useCalibratedValue value"},
    {"Condition", "ComparisonOperator ParameterInstanceRef Value", ""},
    {"ParameterInstanceRef", "", "instance parameterRef useCalibratedValue"},
    // Parameters and containers
    {"ParameterSet", "Parameter ParameterRef", ""},
    {"Parameter", "AliasSet AncillaryDataSet LongDescription ParameterProperties",
     "initialValue name parameterTypeRef shortDescription"},
    {"ParameterProperties", "PhysicalAddressSet SystemName TimeAssociation! ValidityCondition",
     "dataSource persistence readOnly"},
    {"ContainerSet", "SequenceContainer", ""},
    {"SequenceContainer",
     "AliasSet AncillaryDataSet BaseContainer BinaryEncoding DefaultRateInStream EntryList LongDescription "
     "RateInStreamSet",
     "abstract idlePattern name shortDescription"},
    {"BinaryEncoding", "ErrorDetectCorrect! FromBinaryTransformAlgorithm SizeInBits ToBinaryTransformAlgorithm UnitSet",
     "bitOrder byteOrder"},
    {"BaseContainer", "RestrictionCriteria", "containerRef"},
    {"EntryList", "*", ""},
    {"ParameterRefEntry", "AncillaryDataSet IncludeCondition LocationInContainerInBits RepeatEntry TimeAssociation",
     "parameterRef shortDescription"},
    {"ArrayParameterRefEntry",
     "AncillaryDataSet DimensionList IncludeCondition LocationInContainerInBits RepeatEntry TimeAssociation",
     "lastEntryForThisArrayInstance parameterRef shortDescription"},
    {"ContainerRefEntry", "AncillaryDataSet IncludeCondition LocationInContainerInBits RepeatEntry TimeAssociation",
     "containerRef shortDescription"},
    {"LocationInContainerInBits", "DiscreteLookupList DynamicValue FixedValue", "referenceLocation"},
    {"RepeatEntry", "Count Offset", ""},
    // Alarms
    {"DefaultAlarm", "*", alarm_words},
    {"ContextAlarmList", "ContextAlarm", ""},
    {"ContextAlarm", "*", alarm_words},
    {"StaticAlarmRanges", "*", "name rangeForm shortDescription timeUnits!seconds"},
    {"WatchRange", "", range_ends},
    {"WarningRange", "", range_ends},
    {"DistressRange", "", range_ends},
    {"CriticalRange", "", range_ends},
    {"SevereRange", "", range_ends},
    {"EnumerationAlarmList", "EnumerationAlarm", "defaultAlarmLevel"},
    {"EnumerationAlarm", "", "alarmLevel enumerationLabel enumerationValue"},
});

enum class Standing { read, not_read, unknown };

/// Where a name stands in a row's words.
Standing standing_in(std::string_view words, std::string_view name, std::string_view value) {
    while (!words.empty()) {
        const std::string_view word = words.substr(0, words.find(' '));
        words.remove_prefix(std::min(words.size(), word.size() + 1));
        if (word == name) return Standing::read;
        if (word.substr(0, word.find('!')) != name) continue;
        const std::string_view harmless = word.substr(name.size() + 1);
        return !harmless.empty() && harmless == value ? Standing::read : Standing::not_read;
    }
    return Standing::unknown;
}

class GrammarCheck {
  public:
    explicit GrammarCheck(Reporter& report) : report_(report) {
        for (const GrammarRow& row : grammar_rows) rows_.emplace(row.element, &row);
    }

    void check_system(pugi::xml_node system, unsigned depth) {
        if (depth == depth_max) return;
        const pugi::xml_node telemetry = system.child("TelemetryMetaData");
        for (const char* set : {"ParameterTypeSet", "ParameterSet", "ContainerSet"})
            if (const pugi::xml_node found = telemetry.child(set)) {
                check(found, 0);
                if (const pugi::xml_node second = found.next_sibling(set))
                    report_.fault(second, "a second " + std::string{set} + " is not read");
            }
        for (const pugi::xml_node inner : system.children("SpaceSystem")) check_system(inner, depth + 1);
    }

  private:
    const GrammarRow* row_of(pugi::xml_node element) const {
        auto found = rows_.find(std::string{element.parent().name()} + "/" + element.name());
        if (found == rows_.end()) found = rows_.find(element.name());
        return found == rows_.end() ? nullptr : found->second;
    }

    void check(pugi::xml_node element, unsigned depth) {
        const GrammarRow* row = row_of(element);
        if (row == nullptr || depth == depth_max) return;
        const std::string name = element.name();
        for (const pugi::xml_attribute attribute : element.attributes()) {
            const std::string_view word = attribute.name();
            if (word.starts_with("xmlns") || word.find(':') != std::string_view::npos) continue;
            tell(element, standing_in(row->attributes, word, trimmed(attribute.value())),
                 "attribute " + in_quotes(word) + " of " + name);
        }
        for (const pugi::xml_node child : element.children()) {
            if (child.type() != pugi::node_element) continue;
            if (row->children != "*")
                tell(child, standing_in(row->children, child.name(), {}),
                     "element " + in_quotes(child.name()) + " in " + name);
            check(child, depth + 1);
        }
    }

    void tell(pugi::xml_node at, Standing standing, const std::string& what) {
        if (standing == Standing::not_read) report_.fault(at, what + " is not read");
        if (standing == Standing::unknown) report_.fault(at, what + " is unknown or not supported");
    }

    static constexpr unsigned depth_max = 64;  ///< chosen: what is read nests less, and a hostile file cannot exhaust
                                               ///< the stack
    Reporter& report_;
    std::map<std::string, const GrammarRow*, std::less<>> rows_;
};

}  // namespace

void check_grammar(const Document& document, Reporter& report) {
    GrammarCheck{report}.check_system(document.space_system(), 0);
}

}  // namespace aeolis::dictionary::xtce
