// gseditpro server: what an image server is, and a picture that it draws.
#include <cmath>
#include <memory>

#include <fmt/ranges.h>

#include "app/cli/cli.h"
#include "app/cli/server_options.h"
#include "app/engine_names.h"
#include "engine/base/error.h"
#include "engine/base/print.h"
#include "engine/base/printable.h"
#include "engine/io/image/image_file.h"
#include "engine/pipeline/models/remote_loader.h"
#include "engine/pipeline/models/view_server.h"
#include "engine/remote/api/server_kind.h"
#include "engine/remote/views/remote_view_editor.h"

namespace gse::app {
namespace {

struct ServerOptions {
    remote::ServerSettings settings;
    std::filesystem::path draw;
    std::string prompt = "a red ball";
    bool json = false;
    bool find = false;
};

/// Order for a grey ball on a plain ground, with the ball's mask.
remote::RedrawOrder test_order(const remote::ModelFamily& family, int side) {
    auto order = remote::order_of(family);
    order.picture = Image(side, side, 3);
    order.mask = Image(side, side, 1);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const double u = 2.0 * x / side - 1, v = 2.0 * y / side - 1, r = std::hypot(u, v) / 0.5;
            const bool ball = r < 1;
            const double light = ball ? 0.2 + 0.5 * std::sqrt(1 - r * r) : v > 0.3 ? 0.35 + 0.2 * v : 0.75;
            for (int c = 0; c < 3; ++c) order.picture.at(x, y, c) = static_cast<float>(light);
            order.mask.at(x, y, 0) = ball ? 1.0f : 0.0f;
        }
    return order;
}

/// Has the test picture drawn into a file; returns what is to be said of it.
std::string draw_test(const ServerOptions& options, remote::ImageServer& server, const ViewServer& views,
                      const JobControl& job) {
    auto order = test_order(views.family(), views.side());
    order.prompt = options.prompt;
    Mask mask(views.side(), views.side());
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = order.mask.data[i] > 0 ? 1 : 0;
    remote::suit_to_server(order, views.facts(), views.family());
    auto drawn = server.redraw(order, job).picture;
    write_png(options.draw, drawn);
    remote::ViewFrame frame;
    frame.picture = frame.original = order.picture;
    frame.mask = frame.sent_mask = mask;
    const auto checked = remote::check_answer(frame, std::move(drawn));
    return checked.note.empty() ? "the picture is as asked" : checked.note;
}

std::string known(const std::string& text) { return text.empty() ? "not told" : printable(text); }

void print_facts(const ViewServer& views) {
    const auto& facts = views.facts();
    print("server      {} {}\nprotocol    {}\nmodel       {}\n", known(facts.product),
          printable(facts.version), remote::server_kind_name(facts.kind), known(facts.model));
    print("family      {}: {}, {} steps, guidance {}, strength {}, {} x {} pixels\nagreement   {}\n",
          views.family().name,
          views.family().instructed() ? "told what to do" : "told what the picture shows",
          views.family().steps, views.family().guidance_scale, views.family().strength, views.side(),
          views.side(), remote::agreement_name(views.agreement()));
    print("masks       {}\nreferences  {}\nrepeats     {}\n", facts.takes_mask ? "yes" : "no",
          facts.references, facts.repeats ? "yes" : "no");
    for (const auto& model : facts.models) print("offers      {}\n", printable(model));
    for (const auto& lora : facts.loras) print("LoRA        {}\n", printable(lora));
    if (facts.lora_names != remote::LoraNames::Listed)
        print("LoRAs       {}\n",
              facts.lora_names == remote::LoraNames::Any ? "any name or path: it has no list" : "none");
    for (const auto& note : facts.notes) print("note        {}\n", printable(note));
}

void print_servers_here(const ServerOptions& options, const JobControl& job) {
    const auto servers = remote_api().find_here(remote::UsualPorts, job);
    if (options.json) {
        auto list = nlohmann::ordered_json::array();
        for (const auto& one : servers)
            list.push_back(
                {{"url", one.url}, {"product", one.product}, {"model", one.model}, {"problem", one.problem}});
        return print_json(list);
    }
    if (servers.empty())
        print("No program listens on the usual ports of image servers here ({}).\n",
              fmt::join(remote::UsualPorts, ", "));
    for (const auto& one : servers)
        print("{}  {}\n", one.url,
              one.problem.empty() ? fmt::format("{}, model {}", one.product, known(one.model)) : one.problem);
}

void run_server_command(ServerOptions& options, const CommandContext& context) {
    if (options.find == !options.settings.url.empty())
        throw Error(
            ErrorCode::InvalidArgument,
            options.find ? "--find looks on this machine, and takes no address" : "no server is named",
            options.find ? "leave one of them away"
                         : "give its address, or --find to look for servers on this machine");
    if (options.find) return print_servers_here(options, context.job());
    const auto job = context.job();
    std::shared_ptr<remote::ImageServer> server = connect_server(options.settings, job);
    const ViewServer views(server, options.settings, nullptr, job, {},
                           connect_further_servers(options.settings, job));
    std::string said;
    if (!options.draw.empty()) said = draw_test(options, *server, views, job);
    if (options.json) {
        auto json = views.to_json();
        json["models"] = views.facts().models;
        json["loras"] = views.facts().loras;
        json["lora_names"] = remote::lora_names_name(views.facts().lora_names);
        json["notes"] = views.facts().notes;
        json["takes_mask"] = views.facts().takes_mask;
        json["references"] = views.facts().references;
        json["repeats"] = views.facts().repeats;
        if (!said.empty()) json["drawn"] = said;
        return print_json(json);
    }
    print_facts(views);
    if (!said.empty()) print("drawn       {}: {}\n", options.draw.string(), said);
}

}  // namespace

void add_server_command(CLI::App& app, CommandContext& context) {
    auto options = std::make_shared<ServerOptions>();
    auto* command = app.add_subcommand("server", "Ask an image server what it is and what it can do");
    add_server_options(*command, options->settings);
    auto* address = command->get_option("--server");
    command->remove_option(address);
    command->add_option("url", options->settings.url, "Address of the server");
    command->add_flag("--find", options->find,
                      "List the image servers on this machine, by their usual ports; no picture is sent");
    command->add_option("--draw", options->draw,
                        "Have a test picture drawn, a ball on the ground, and write it to this PNG");
    command->add_option("--prompt", options->prompt, "Sentence for the test picture")->capture_default_str();
    command->add_flag("--json", options->json, "Print JSON");
    command->callback([options, &context] { run_server_command(*options, context); });
}

}  // namespace gse::app
