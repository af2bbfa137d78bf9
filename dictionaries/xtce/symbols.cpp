// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/symbols.hpp"

#include <algorithm>

namespace aeolis::dictionary::xtce {
namespace {

constexpr unsigned system_depth_max =
    8;  // of nested SpaceSystems; chosen, so that a hostile file cannot exhaust the stack

}  // namespace

Symbols::Symbols(const std::vector<const Document*>& documents, Reporter& report, Names names) : names_(names) {
    for (const Document* document : documents) read_space_system(document->space_system(), "", 0, report);
}

void Symbols::read_space_system(pugi::xml_node system, const std::string& outer, unsigned depth, Reporter& report) {
    if (depth == system_depth_max) {
        report.fault(system, "SpaceSystems are nested deeper than " + std::to_string(system_depth_max));
        return;
    }
    const bool ours = names_ == Names::strict;
    report.expect(system,
                  {"LongDescription", "AncillaryDataSet", "Header", "TelemetryMetaData", "CommandMetaData",
                   "SpaceSystem", ours ? "" : "AliasSet"},
                  {"name", "shortDescription", "operationalStatus", "systemType", "xsi:schemaLocation",
                   ours ? "" : "assetType", ours ? "" : "xml:base"});
    const std::string scope = outer + "/" + name_of(system);

    const pugi::xml_node telemetry = system.child("TelemetryMetaData");
    report.expect(telemetry, {"ParameterTypeSet", "ParameterSet", "ContainerSet", "AlgorithmSet"}, {});
    for (const pugi::xml_node algorithm : telemetry.child("AlgorithmSet").children())
        if (algorithm.type() == pugi::node_element)
            report.fault(algorithm,
                         std::string{algorithm.name()} + " " + in_quotes(name_of(algorithm)) + " is not run");
    read_set(telemetry.child("ParameterTypeSet"), Kind::parameter_type, scope, report);
    read_set(telemetry.child("ParameterSet"), Kind::parameter, scope, report);
    read_set(telemetry.child("ContainerSet"), Kind::container, scope, report);

    const pugi::xml_node commands = system.child("CommandMetaData");
    report.expect(commands, {"ArgumentTypeSet", "MetaCommandSet"}, {});
    read_set(commands.child("ArgumentTypeSet"), Kind::argument_type, scope, report);
    read_set(commands.child("MetaCommandSet"), Kind::command, scope, report);
    for (const pugi::xml_node command : commands.child("MetaCommandSet").children("MetaCommand"))
        if (const pugi::xml_node container = command.child("CommandContainer"))
            add(Kind::command_container, scope, container, report);

    for (const pugi::xml_node inner : system.children("SpaceSystem"))
        read_space_system(inner, scope, depth + 1, report);
}

void Symbols::read_set(pugi::xml_node set, Kind kind, const std::string& scope, Reporter& report) {
    for (const pugi::xml_node element : set.children())
        if (element.type() == pugi::node_element) add(kind, scope, element, report);
}

void Symbols::add(Kind kind, const std::string& scope, pugi::xml_node element, Reporter& report) {
    const std::string name = name_of(element);
    if (name.empty() || name.find_first_of(names_ == Names::strict ? "./:[] " : "/") != std::string::npos) {
        report.fault(element, std::string{element.name()} + " has no usable name");
        return;
    }
    const std::string path = scope + "/" + name;
    const auto [first, added] = by_path_.emplace(std::pair{kind, path}, all_.size());
    if (added)
        all_.push_back({kind, path, scope, element});
    else
        report.fault(element, std::string{element.name()} + " " + in_quotes(name) + " is there twice, first in line " +
                                  std::to_string(report.line(all_[first->second].element)));
}

namespace {

/// The path to which a reference with "." and ".." leads from a scope; empty when it leads out of the file.
std::string path_from(const std::string& scope, std::string_view reference) {
    std::string path = reference.starts_with('/') ? std::string{} : scope;
    while (!reference.empty()) {
        const std::string_view part = reference.substr(0, reference.find('/'));
        reference.remove_prefix(std::min(reference.size(), part.size() + 1));
        if (part.empty() || part == ".") continue;
        if (part != "..")
            path += "/" + std::string{part};
        else if (path.empty())
            return {};
        else
            path.erase(path.rfind('/'));
    }
    return path;
}

}  // namespace

const Symbol* Symbols::find(Kind kind, const std::string& scope, std::string_view reference) const {
    const auto at = [&](const std::string& path) -> const Symbol* {
        const auto found = by_path_.find(std::pair{kind, path});
        return found == by_path_.end() ? nullptr : &all_[found->second];
    };
    if (reference.empty()) return nullptr;
    if (reference.front() == '/' || reference.starts_with("./") || reference.starts_with("../"))
        return at(path_from(scope, reference));
    for (std::string from = scope;; from.erase(from.rfind('/'))) {
        if (const Symbol* found = at(path_from(from, reference))) return found;
        if (from.empty()) return nullptr;
    }
}

}  // namespace aeolis::dictionary::xtce
