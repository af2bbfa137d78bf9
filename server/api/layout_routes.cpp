// SPDX-License-Identifier: Apache-2.0
#include "aeolis/v1/layout.pb.h"
#include "server/api/api.hpp"
#include "server/base/json.hpp"
#include "server/base/wall_clock.hpp"

#include <fmt/format.h>

// The routes of layouts. A layout concerns the display of its person alone, so it needs the right to watch and no more.
namespace aeolis::server {
namespace {

/// The owner of the layouts that the operator sees: a person or program with an account, else everyone.
std::string owner_of(const Operator& who) {
    return who.accounts ? who.user : "";
}

HttpResponse outcome_response(const Result<archive::LayoutOutcome>& outcome, const archive::LayoutChange& change) {
    if (!outcome) return disk_response("nothing was changed: " + outcome.error().message);
    switch (*outcome) {
    case archive::LayoutOutcome::absent:
        return error_response(404, fmt::format("there is no layout '{}'", change.name));
    case archive::LayoutOutcome::full:
        return error_response(
            409, fmt::format("there are {} layouts, which is the most: remove one first", archive::layouts_max));
    case archive::LayoutOutcome::done: break;
    }
    if (!change.view) return {204, "application/json", "no-store", ""};
    v1::Layout saved;
    saved.set_name(change.name);
    saved.set_view(*change.view);
    saved.set_saved(change.saved);
    return json_response(saved);
}

}  // namespace

void Api::list_layouts(const ApiRequest& call) {
    answer_page(call, ListPage::usual(archive::Order::oldest_first),
                [owner = owner_of(call.who)](archive::Reader& reader, const ListRequest& wanted) {
                    const auto layouts = reader.layouts(owner);
                    if (!layouts) return error_response(500, layouts.error());
                    v1::LayoutList list;
                    list.set_layouts_max(archive::layouts_max);
                    for (const auto& layout : *layouts) {
                        auto& shown = *list.add_layouts();
                        shown.set_name(layout.name);
                        shown.set_view(layout.view);
                        shown.set_saved(layout.saved);
                    }
                    return wanted.response_of_whole(std::move(list), {"layouts"});
                });
}

void Api::put_layout(const ApiRequest& call) {
    v1::Layout wanted;
    if (auto unreadable = read_body(call.request.body, wanted)) return call.respond(std::move(*unreadable));
    if (const auto name = archive::check_layout_name(call.parts[0]); !name)
        return call.respond(error_response(422, name.error()));
    if (!wanted.name().empty() && wanted.name() != call.parts[0])
        return call.respond(error_response(422, "name: another than that of the path; leave it out"));
    if (const auto view = archive::check_layout_view(wanted.view()); !view)
        return call.respond(error_response(422, view.error()));
    change_layout(call, {owner_of(call.who), call.parts[0], wanted.view(), wall_clock_text()});
}

void Api::remove_layout(const ApiRequest& call) {
    if (!archive::check_layout_name(call.parts[0]))
        return call.respond(error_response(404, "there is no layout of such a name"));
    change_layout(call, {owner_of(call.who), call.parts[0], {}, {}});
}

void Api::change_layout(const ApiRequest& call, archive::LayoutChange change) {
    const auto done = [respond = call.respond, change](const Result<archive::LayoutOutcome>& outcome) {
        respond(outcome_response(outcome, change));
    };
    if (!parts_.pipeline.change_layout(std::move(change), done))
        call.respond(full_response("nothing was changed, too much waits to be stored: try again"));
}

}  // namespace aeolis::server
