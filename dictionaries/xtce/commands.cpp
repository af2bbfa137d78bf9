// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/commands.hpp"

#include "common/space_packet.hpp"
#include "dictionaries/words.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace aeolis::dictionary::xtce {
namespace {

constexpr std::int64_t opcode_max = 0xFFFF;
constexpr unsigned argument_bits_max = static_cast<unsigned>(packet_octets_max - tc_overhead_octets) * 8;

// XTCE 1.2 names the significances of commands differently from the levels of alarms.
constexpr std::array significances{
    std::pair{"normal", Significance::none},       std::pair{"user1", Significance::watch},
    std::pair{"vital", Significance::warning},     std::pair{"user2", Significance::distress},
    std::pair{"critical", Significance::critical}, std::pair{"forbidden", Significance::severe}};

/// xs:duration in days, hours, minutes and seconds: "PT10S", "P1DT2H30M".
std::optional<double> to_seconds(std::string_view word) {
    if (!word.starts_with("P") || word.size() < 3) return std::nullopt;
    word.remove_prefix(1);
    double total_s = 0.0;
    bool in_time = false;
    while (!word.empty()) {
        if (word.front() == 'T' && !in_time) {
            in_time = true;
            word.remove_prefix(1);
            continue;
        }
        const std::size_t end = word.find_first_not_of("0123456789.");
        if (end == std::string_view::npos) return std::nullopt;
        const auto amount = to_number(word.substr(0, end));
        const char unit = word[end];
        const double unit_s = !in_time && unit == 'D'  ? 86400.0
                              : in_time && unit == 'H' ? 3600.0
                              : in_time && unit == 'M' ? 60.0
                              : in_time && unit == 'S' ? 1.0
                                                       : 0.0;
        if (!amount || unit_s == 0.0) return std::nullopt;
        total_s += *amount * unit_s;
        word.remove_prefix(end + 1);
    }
    return total_s;
}

class CommandReader {
  public:
    CommandReader(const Symbols& symbols, const Types& types, const Parameters& parameters, const Packets& packets,
                  Reporter& report)
        : symbols_(symbols), types_(types), parameters_(parameters), packets_(packets), report_(report) {}

    void read(const Symbol& symbol) {
        const pugi::xml_node element = symbol.element;
        if (std::string_view{element.name()} != "MetaCommand") {
            report_.fault(element, std::string{element.name()} + " is not supported");
            return;
        }
        report_.expect(element,
                       {"LongDescription", "BaseMetaCommand", "ArgumentList", "CommandContainer",
                        "TransmissionConstraintList", "DefaultSignificance", "VerifierSet"},
                       {"name", "shortDescription", "abstract"});
        if (element.attribute("abstract").as_bool()) return;
        Command command;
        command.name = name_of(element);
        command.text = element.attribute("shortDescription").value();
        if (const auto why = unusable_as_identifier(command.name)) fault(element, command, *why);
        if (!read_opcode(symbol, command)) return;
        read_arguments(symbol, command);
        read_significance(element, command);
        read_preconditions(symbol, command);
        read_verifiers(symbol, command);
        commands.push_back(std::move(command));
    }

    std::vector<Command> commands;

  private:
    void fault(pugi::xml_node at, const Command& command, const std::string& message) {
        report_.fault(at, "command " + in_quotes(command.name) + ": " + message);
    }

    /// The opcode is the one argument that a base command declares and this command assigns.
    bool read_opcode(const Symbol& symbol, Command& command) {
        const pugi::xml_node base = symbol.element.child("BaseMetaCommand");
        report_.expect(base, {"ArgumentAssignmentList"}, {"metaCommandRef"});
        const std::string reference = base.attribute("metaCommandRef").value();
        if (base && symbols_.find(Kind::command, symbol.scope, reference) == nullptr) {
            fault(base, command, "there is no command " + in_quotes(reference));
            return false;
        }
        std::optional<std::int64_t> opcode;
        const pugi::xml_node list = base.child("ArgumentAssignmentList");
        report_.expect(list, {"ArgumentAssignment"}, {});
        for (const pugi::xml_node assignment : list.children("ArgumentAssignment")) {
            report_.expect(assignment, {}, {"argumentName", "argumentValue"});
            if (std::string_view{assignment.attribute("argumentName").value()} != "opcode") {
                fault(assignment, command, "only the opcode can be assigned so far");
                return false;
            }
            opcode = report_.integer(assignment, "argumentValue", 0, opcode_max);
            if (!opcode) return false;
        }
        if (!opcode) {
            fault(symbol.element, command, "has no opcode");
            return false;
        }
        command.opcode = Opcode{static_cast<std::uint16_t>(*opcode)};
        const auto [first, added] = opcode_lines_.emplace(command.opcode, report_.line(symbol.element));
        if (!added)
            fault(symbol.element, command,
                  "opcode " + std::to_string(*opcode) + " is taken, first in line " + std::to_string(first->second));
        return true;
    }

    void read_arguments(const Symbol& symbol, Command& command) {
        std::map<std::string, Argument> declared;
        std::set<std::string> unreadable;
        const pugi::xml_node list = symbol.element.child("ArgumentList");
        report_.expect(list, {"Argument"}, {});
        for (const pugi::xml_node element : list.children("Argument")) {
            report_.expect(element, {"LongDescription"},
                           {"name", "argumentTypeRef", "shortDescription", "initialValue"});
            const std::string name = name_of(element);
            const auto type = types_.of(Kind::argument_type, symbol.scope, element, "argumentTypeRef", report_);
            if (const auto why = unusable_as_identifier(name))
                fault(element, command, "argument " + in_quotes(name) + " " + *why);
            if (is_taken_in_commands(name))
                fault(element, command, "argument " + in_quotes(name) + " is a name of the decoder's own");
            if (!type) {
                unreadable.insert(name);
                continue;
            }
            Argument argument{name, element.attribute("shortDescription").value(), *type, 0,
                              report_.number(element, "initialValue")};
            check_default(element, command, argument);
            if (!declared.emplace(name, std::move(argument)).second)
                fault(element, command, "argument " + in_quotes(name) + " is there twice");
        }
        if (unreadable.empty()) place_arguments(symbol, command, declared);
    }

    void check_default(pugi::xml_node element, const Command& command, const Argument& argument) {
        if (!argument.default_value) return;
        const double value = *argument.default_value;
        const Type& type = argument.type;
        if (value < type.valid_min.value_or(value) || value > type.valid_max.value_or(value))
            fault(element, command,
                  "argument " + in_quotes(argument.name) + ": default " + number_word(value) +
                      " is outside its valid range");
    }

    void place_arguments(const Symbol& symbol, Command& command, std::map<std::string, Argument>& declared) {
        const pugi::xml_node container = symbol.element.child("CommandContainer");
        report_.expect(container, {"EntryList", "BaseContainer"}, {"name", "shortDescription"});
        const std::string base = container.child("BaseContainer").attribute("containerRef").value();
        if (!base.empty() && symbols_.find(Kind::command_container, symbol.scope, base) == nullptr &&
            symbols_.find(Kind::container, symbol.scope, base) == nullptr)
            fault(container.child("BaseContainer"), command, "there is no container " + in_quotes(base));
        unsigned position = 0;
        for (const pugi::xml_node entry : container.child("EntryList").children()) {
            if (entry.type() != pugi::node_element) continue;
            if (std::string_view{entry.name()} != "ArgumentRefEntry") {
                fault(entry, command, std::string{entry.name()} + " is not supported");
                return;
            }
            report_.expect(entry, {}, {"argumentRef"});
            const std::string reference = entry.attribute("argumentRef").value();
            const auto argument = declared.find(reference);
            if (argument == declared.end()) {
                fault(entry, command, "there is no argument " + in_quotes(reference) + ", or it is there twice");
                return;
            }
            argument->second.position_bits = position;
            position += argument->second.type.bits;
            command.arguments.push_back(std::move(argument->second));
            declared.erase(argument);
        }
        for (const auto& [name, argument] : declared)
            fault(container ? container : symbol.element, command,
                  "argument " + in_quotes(name) + " is not in its container");
        if (position > argument_bits_max) fault(container, command, "the arguments do not fit a packet");
        command.argument_octets = (position + 7) / 8;
    }

    void read_significance(pugi::xml_node element, Command& command) {
        const pugi::xml_node significance = element.child("DefaultSignificance");
        if (!significance) return;
        report_.expect(significance, {}, {"consequenceLevel", "reasonForWarning"});
        const std::string word = significance.attribute("consequenceLevel").as_string("normal");
        const auto level = std::ranges::find(significances, word, [](const auto& s) { return std::string{s.first}; });
        if (level == significances.end())
            fault(significance, command, "consequence level " + in_quotes(word) + " is unknown");
        else
            command.significance = level->second;
        command.reason_for_warning = significance.attribute("reasonForWarning").value();
    }

    void read_preconditions(const Symbol& symbol, Command& command) {
        const pugi::xml_node list = symbol.element.child("TransmissionConstraintList");
        report_.expect(list, {"TransmissionConstraint"}, {});
        for (const pugi::xml_node constraint : list.children("TransmissionConstraint")) {
            report_.expect(constraint, {"Comparison", "ComparisonList"}, {});
            report_.expect(constraint.child("ComparisonList"), {"Comparison"}, {});
            for (const pugi::xml_node comparison : constraint.children("Comparison"))
                read_precondition(symbol, comparison, command);
            for (const pugi::xml_node comparison : constraint.child("ComparisonList").children("Comparison"))
                read_precondition(symbol, comparison, command);
        }
    }

    void read_precondition(const Symbol& symbol, pugi::xml_node comparison, Command& command) {
        auto condition = read_comparison(symbols_, parameters_, symbol.scope, comparison,
                                         "command " + in_quotes(command.name), report_);
        if (condition) command.preconditions.push_back(std::move(*condition));
    }

    void read_verifiers(const Symbol& symbol, Command& command) {
        const pugi::xml_node set = symbol.element.child("VerifierSet");
        report_.expect(set, {"AcceptedVerifier", "CompleteVerifier", "FailedVerifier"}, {});
        std::optional<EvrId> failure;
        if (const pugi::xml_node failed = set.child("FailedVerifier"))
            if (const auto verifier = read_verifier(symbol, failed, command)) failure = verifier->event;
        for (const auto& [element, stage] :
             {std::pair{"AcceptedVerifier", "accepted"}, std::pair{"CompleteVerifier", "executed"}})
            for (const pugi::xml_node child : set.children(element))
                if (auto verifier = read_verifier(symbol, child, command)) {
                    verifier->stage = stage;
                    verifier->failure_event = failure;
                    command.verifiers.push_back(std::move(*verifier));
                }
    }

    std::optional<Verifier> read_verifier(const Symbol& symbol, pugi::xml_node element, const Command& command) {
        report_.expect(element, {"ContainerRef", "CheckWindow"}, {"name", "shortDescription"});
        const pugi::xml_node container = element.child("ContainerRef");
        const std::string reference = container.attribute("containerRef").value();
        const Symbol* found = symbols_.find(Kind::container, symbol.scope, reference);
        if (found == nullptr) {
            fault(container ? container : element, command, "there is no container " + in_quotes(reference));
            return std::nullopt;
        }
        const pugi::xml_node window = element.child("CheckWindow");
        report_.expect(window, {}, {"timeToStartChecking", "timeToStopChecking", "timeWindowIsRelativeTo"});
        const std::string relative = window.attribute("timeWindowIsRelativeTo").value();
        const auto window_s = to_seconds(window.attribute("timeToStopChecking").value());
        if (!window_s || relative != "commandRelease") {
            fault(window ? window : element, command, "a check window is a duration from commandRelease");
            return std::nullopt;
        }
        const auto event = packets_.event_by_path.find(found->path);
        if (event != packets_.event_by_path.end()) return Verifier{{}, event->second, std::nullopt, *window_s};
        const auto is_declared = [&](const auto& e) { return e.name == name_of(found->element); };
        if (std::ranges::none_of(packets_.declared_events, is_declared))  // otherwise it has findings of its own
            fault(container, command, in_quotes(reference) + " is no event");
        return std::nullopt;
    }

    const Symbols& symbols_;
    const Types& types_;
    const Parameters& parameters_;
    const Packets& packets_;
    Reporter& report_;
    std::map<Opcode, unsigned> opcode_lines_;
};

}  // namespace

std::vector<Command> read_commands(const Symbols& symbols, const Types& types, const Parameters& parameters,
                                   const Packets& packets, Reporter& report) {
    CommandReader reader{symbols, types, parameters, packets, report};
    for (const Symbol& symbol : symbols.all())
        if (symbol.kind == Kind::command) reader.read(symbol);
    return std::move(reader.commands);
}

}  // namespace aeolis::dictionary::xtce
