// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign_manager.hpp"

#include "server/campaign/campaign_results.hpp"
#include "server/scenario/script_check.hpp"

#include <algorithm>
#include <atomic>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <thread>

namespace aeolis::server::campaign {
namespace {

constexpr std::string_view file_prefix = "campaign-", file_extension = ".db";

std::string name_of_file(const std::filesystem::path& file) {
    const auto name = file.filename().string();
    if (!name.starts_with(file_prefix) || !name.ends_with(file_extension)) return {};
    return name.substr(file_prefix.size(), name.size() - file_prefix.size() - file_extension.size());
}

/// The campaign files, newest first. An unreadable one is left out: the folder may change meanwhile.
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
    std::vector<std::pair<std::filesystem::file_time_type, std::filesystem::path>> found;
    std::error_code error;
    for (std::filesystem::directory_iterator entry{folder, error}, end; !error && entry != end;
         entry.increment(error)) {
        std::error_code gone;
        if (name_of_file(entry->path()).empty() || !entry->is_regular_file(gone)) continue;
        if (const auto written = entry->last_write_time(gone); !gone) found.emplace_back(written, entry->path());
    }
    std::ranges::sort(found, std::greater{});
    std::vector<std::filesystem::path> files;
    files.reserve(found.size());
    for (auto& [written, file] : found) files.push_back(std::move(file));
    return files;
}

/// The state of a campaign from its file.
v1::CampaignState kept_in(const std::filesystem::path& file) {
    v1::CampaignState state;
    state.set_campaign(name_of_file(file));
    const auto header = results_header(file);
    if (!header) {
        state.set_state("unreadable");
        state.set_fault(header.error().message);
        return state;
    }
    state.set_scenario(header->scenario);
    state.set_seed(header->seed);
    state.set_cases(static_cast<std::uint32_t>(header->cases));
    state.set_kept(static_cast<std::uint32_t>(header->kept));
    state.set_state(header->kept >= header->cases ? "complete" : "incomplete");
    return state;
}

v1::Spread message_of(const Spread& spread) {
    v1::Spread message;
    message.set_count(static_cast<std::uint32_t>(spread.count));
    message.set_min(spread.least);
    message.set_p1(spread.p1);
    message.set_p50(spread.p50);
    message.set_p99(spread.p99);
    message.set_max(spread.most);
    message.set_mean(spread.mean);
    message.set_sigma(spread.sigma);
    return message;
}

void add(const Summary& summary, v1::CampaignReport& report) {
    for (const auto& [outcome, count] : summary.outcomes) {
        auto& row = *report.add_outcomes();
        row.set_outcome(outcome);
        row.set_count(static_cast<std::uint32_t>(count));
    }
    *report.mutable_miss_m() = message_of(summary.miss_m);
    *report.mutable_vertical_mps() = message_of(summary.vertical_mps);
    *report.mutable_horizontal_mps() = message_of(summary.horizontal_mps);
    *report.mutable_propellant_kg() = message_of(summary.propellant_kg);
    *report.mutable_parachute_mach() = message_of(summary.parachute_mach);
    *report.mutable_parachute_pressure_pa() = message_of(summary.parachute_pressure_Pa);
    *report.mutable_peak_deceleration_mps2() = message_of(summary.peak_deceleration_mps2);
    if (summary.miss_m.count >= 2) {
        auto& ellipse = *report.mutable_ellipse();
        ellipse.set_east_m(summary.ellipse.east_m);
        ellipse.set_north_m(summary.ellipse.north_m);
        ellipse.set_major_m(summary.ellipse.major_m);
        ellipse.set_minor_m(summary.ellipse.minor_m);
        ellipse.set_azimuth_deg(summary.ellipse.azimuth_deg);
    }
    for (const auto& margin : summary.margins) {
        auto& row = *report.add_margins();
        row.set_timepoint(margin.timepoint);
        *row.mutable_margin_s() = message_of(margin.margin_s);
    }
    if (const auto& least = summary.least_margin) {
        auto& row = *report.mutable_least_margin();
        row.set_margin_s(least->margin_s);
        row.set_timepoint(least->timepoint);
        row.set_case_(static_cast<std::uint32_t>(least->number));
    }
    report.set_recontacts(static_cast<std::uint32_t>(summary.recontacts));
    report.set_failed(static_cast<std::uint32_t>(summary.failed));
    const auto fill = [](const Failure& failure, v1::CampaignFailure& row) {
        row.set_case_(static_cast<std::uint32_t>(failure.number));
        row.set_outcome(failure.outcome);
        row.set_reason(failure.reason);
    };
    for (const auto& failure : summary.failures) fill(failure, *report.add_failures());
    report.set_outside_limits(static_cast<std::uint32_t>(summary.outside_limits));
    for (const auto& outside : summary.outside) fill(outside, *report.add_outside());
}

}  // namespace

/// The campaign in flight, and afterwards its end. Its thread writes; others read.
struct CampaignManager::Flight {
    std::string name;
    Order order;
    std::optional<CampaignStore> store;  ///< none once over: other programs may then open the file
    std::atomic<bool> stop{false}, begun{false}, over{false};
    std::atomic<double> rate_per_s{0.0};
    std::string fault{};  ///< set when over
    std::thread thread{};

    Flight(std::string of, Order asked, CampaignStore into)
        : name(std::move(of)), order(std::move(asked)), store(std::move(into)) {}
    Flight(const Flight&) = delete;
    Flight& operator=(const Flight&) = delete;
    ~Flight() {
        stop = true;
        if (thread.joinable()) thread.join();
    }

    void fly(const dictionary::Dictionary& dictionary) {
        Result<Progress> flown = Error{""};
        try {
            flown = campaign::fly(*store, order, dictionary, stop, [this](const Progress& progress) {
                begun = true;
                rate_per_s = progress.rate_per_s();
            });
        } catch (const std::exception& bug) {
            flown = Error{fmt::format("this is a fault of the server: {}", bug.what())};
        }
        if (!flown) fault = flown.error().message;
        if (flown)
            spdlog::info("campaign {}: {} of {} cases are kept", name, flown->done, flown->of);
        else
            spdlog::error("campaign {}: {}", name, fault);
        store.reset();
        over = true;
    }
};

CampaignManager::CampaignManager(std::filesystem::path folder, const ScenarioLibrary& scenarios,
                                 const dictionary::Dictionary& dictionary)
    : folder_(folder.empty() ? "." : std::move(folder)), scenarios_(scenarios), dictionary_(dictionary) {}

CampaignManager::~CampaignManager() = default;

unsigned CampaignManager::jobs_max() {
    return std::max(1U, std::thread::hardware_concurrency());
}

void CampaignManager::close(std::string reason) {
    const std::scoped_lock lock{mutex_};
    closed_ = std::move(reason);
}

bool CampaignManager::flying() const {
    return flight_ && !flight_->over;
}

Result<Order> CampaignManager::order_of(const v1::StartCampaign& request) const {
    auto scenario = scenarios_.scenario(request.scenario());
    if (!scenario) return scenario.error();
    if (const auto flyable = check(*scenario); !flyable)
        return Error{request.scenario() + ": " + flyable.error().message};
    if (const auto script = check_script(*scenario, dictionary_); !script)
        return Error{request.scenario() + ": " + script.error().message};
    if (request.cases() < 1 || request.cases() > cases_max)
        return Error{fmt::format("cases: {} is not within 1 … {}", request.cases(), cases_max)};
    if (request.jobs() > jobs_max())
        return Error{fmt::format("jobs: {} is more than the processors here ({})", request.jobs(), jobs_max())};
    if (request.seed() > static_cast<std::uint64_t>(INT64_MAX))
        return Error{fmt::format("seed: {} is more than {}", request.seed(), INT64_MAX)};
    const unsigned jobs = request.jobs() != 0 ? request.jobs() : std::max(1U, jobs_max() - 1);
    return Order{std::move(*scenario),
                 request.seed(),
                 request.cases(),
                 jobs,
                 results_file(folder_, request.scenario(), request.seed()),
                 true};
}

Result<v1::CampaignState> CampaignManager::start(Order order) {
    const auto file = order.file;
    {
        const std::scoped_lock lock{mutex_};
        if (!closed_.empty()) return Error{closed_};
        if (flying() && flight_->stop)
            return Error{fmt::format("the campaign {} is being cancelled: try again in a moment", flight_->name)};
        if (flying())
            return Error{fmt::format("the campaign {} flies: cancel it first, or wait for its end", flight_->name)};
        flight_.reset();
        auto store = open_store(order, dictionary_);
        if (!store) return Error{store.error().message + "; another seed makes another campaign"};
        auto flight = std::make_unique<Flight>(name_of_file(file), std::move(order), std::move(*store));
        flight->thread = std::thread{[flying = flight.get(), this] { flying->fly(dictionary_); }};
        flight_ = std::move(flight);
    }
    return state_of(file);
}

Result<v1::CampaignState> CampaignManager::cancel(const std::string& campaign) {
    std::filesystem::path file;
    {
        const std::scoped_lock lock{mutex_};
        if (!flying() || flight_->name != campaign) return Error{fmt::format("the campaign {} does not fly", campaign)};
        flight_->stop = true;
        file = flight_->order.file;
    }
    return state_of(file);
}

v1::CampaignState CampaignManager::state_of(const std::filesystem::path& file) {
    auto state = kept_in(file);
    const std::scoped_lock lock{mutex_};
    if (!flight_ || flight_->name != state.campaign() || state.state() == "unreadable") return state;
    if (flight_->over) {
        state.set_fault(flight_->fault);
        return state;
    }
    state.set_state(flight_->stop ? "cancelling" : flight_->begun ? "flying" : "preparing");
    state.set_jobs(flight_->order.jobs);
    const double rate_per_s = flight_->rate_per_s;
    state.set_rate_per_s(rate_per_s);
    if (rate_per_s > 0.0 && !flight_->stop)
        state.set_remaining_s(static_cast<double>(state.cases() - state.kept()) / rate_per_s);
    return state;
}

v1::CampaignList CampaignManager::list() {
    v1::CampaignList list;
    list.set_cases_max(cases_max);
    list.set_jobs_max(jobs_max());
    const auto files = files_in(folder_);
    for (auto file = files.rbegin(); file != files.rend(); ++file) *list.add_campaigns() = state_of(*file);
    return list;
}

std::optional<std::filesystem::path> CampaignManager::file_of(const std::string& campaign) const {
    // The name comes from a client: it is looked up among the files and never made a path.
    for (auto& file : files_in(folder_))
        if (name_of_file(file) == campaign) return std::move(file);
    return std::nullopt;
}

Result<v1::CampaignReport> CampaignManager::report(const std::filesystem::path& file, std::function<bool()> stop) {
    v1::CampaignReport report;
    *report.mutable_state() = state_of(file);
    if (report.state().state() == "unreadable") return Error{report.state().fault()};
    auto results = CampaignResults::open(file, report.state().cases());
    if (!results) return results.error();
    results->stop_when(std::move(stop));
    const auto summary = results->brief();
    if (!summary) return summary.error();
    report.mutable_state()->set_kept(static_cast<std::uint32_t>(summary->kept));  // consistent with the summary
    add(*summary, report);
    return report;
}

Result<v1::CampaignTouchdowns> CampaignManager::touchdowns(const std::filesystem::path& file, std::uint64_t place,
                                                           std::uint64_t limit, std::function<bool()> stop) {
    const auto header = results_header(file);
    if (!header) return header.error();
    auto results = CampaignResults::open(file, header->cases);
    if (!results) return results.error();
    results->stop_when(std::move(stop));
    const auto found = results->arrivals(place, limit);
    if (!found) return found.error();
    v1::CampaignTouchdowns page;
    page.set_next_after(static_cast<std::uint32_t>(place));
    for (const auto& touchdown : *found) {
        auto& row = *page.add_touchdowns();
        row.set_place(static_cast<std::uint32_t>(touchdown.place));
        row.set_case_(static_cast<std::uint32_t>(touchdown.number));
        row.set_outcome(touchdown.outcome);
        if (touchdown.east_m) row.set_east_m(*touchdown.east_m);
        if (touchdown.north_m) row.set_north_m(*touchdown.north_m);
        page.set_next_after(row.place());
    }
    return page;
}

}  // namespace aeolis::server::campaign
