// SPDX-License-Identifier: Apache-2.0
#include "server/api/static_files.hpp"

#include <array>
#include <fstream>
#include <iterator>

namespace aeolis::server {
namespace {

struct ContentType {
    std::string_view extension;
    const char* type;
};
constexpr std::array content_types{
    ContentType{".html", "text/html; charset=utf-8"},
    ContentType{".js", "text/javascript; charset=utf-8"},
    ContentType{".css", "text/css; charset=utf-8"},
    ContentType{".json", "application/json"},
    ContentType{".map", "application/json"},
    ContentType{".svg", "image/svg+xml"},
    ContentType{".png", "image/png"},
    ContentType{".ico", "image/x-icon"},
    ContentType{".woff2", "font/woff2"},
    ContentType{".txt", "text/plain; charset=utf-8"},
    ContentType{".yaml", "application/yaml"},
};

const char* content_type_of(const std::filesystem::path& file) {
    for (const auto& [extension, type] : content_types)
        if (file.extension() == extension) return type;
    return "application/octet-stream";
}

/// Whether the file is below assets/, where names contain a hash of the contents: such a file never changes.
bool is_hashed(std::string_view path) {
    return path.starts_with("/assets/");
}

constexpr const char* not_built_page = "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Aeolis</title>"
                                       "<body><h1>The console is not built</h1><p>This server runs, and its interface "
                                       "is at <a href=\"/api/v1/runs\">/api/v1</a> (described in <a "
                                       "href=\"/api/v1/openapi.yaml\">openapi.yaml</a>). To build the page, run "
                                       "<code>./run</code> in the checkout, or <code>npm ci &amp;&amp; npm run "
                                       "build</code> in <code>web/</code>, and load this page again.</p></body></html>";

}  // namespace

HttpResponse StaticFiles::file(std::string_view path) const {
    HttpResponse response;
    std::error_code error;
    const auto root = std::filesystem::canonical(directory_, error);
    if (error || !std::filesystem::is_regular_file(root / "index.html", error))
        return {503, "text/html; charset=utf-8", "no-store", not_built_page, {{"Retry-After", "10"}}};

    const std::filesystem::path wanted{path == "/" ? "index.html" : path.substr(1)};
    const auto file = std::filesystem::canonical(root / wanted, error);
    const auto [mismatch, unused] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
    if (error || mismatch != root.end() || !std::filesystem::is_regular_file(file, error) ||
        std::filesystem::file_size(file, error) > file_octets_max)
        return error_response(404, std::string{path} + ": there is no such file in the console");

    std::ifstream stream{file, std::ios::binary};
    response.body.assign(std::istreambuf_iterator<char>{stream}, {});
    response.content_type = content_type_of(file);
    response.cache_control = is_hashed(path) ? "public, max-age=31536000, immutable" : "no-cache";
    return response;
}

}  // namespace aeolis::server
