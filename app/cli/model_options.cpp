// Some of the fields of a job.
#include "app/cli/model_options.h"

#include "app/cli/cli.h"

namespace gse::app {

void add_model_options(CLI::App& command, pipeline::JobParameters& job) {
    pipeline::JobParameters::visit_fields(
        job, [&](const char* name, auto& value, const char* help, const auto&... range) {
            const std::string field(name);
            if (field == "model" || field == "lora" || field == "taesd" || field == "segmenter" ||
                field == "text_segmenter" || field == "precision")
                add_field_option(command, option_name(name), value, help, range...);
        });
}

}  // namespace gse::app
