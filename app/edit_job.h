// One run of locate or edit from files to files: what the commands and the window both call.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/scene_tools.h"
#include "engine/edit/cached_attention.h"
#include "engine/edit/locate.h"
#include "engine/edit/session.h"
#include "engine/neural/api.h"

namespace gse::app {

/// Files and machine of a run; with the request and the guidance's settings this is the whole recipe.
struct JobParameters {
    std::string scene;
    std::string cameras;
    std::string model;
    std::string device = "cpu";
    int threads = 1;
    std::string up = "auto";
    std::string front;
    int turntable_size = 480;
    int turntable_frames = 60;

    template <class Self, class F>
    static void visit_fields(Self& self, F&& f) {
        f("scene", self.scene, "Scene file or folder.");
        f("cameras", self.cameras,
          "COLMAP folder, transforms.json or cameras.json; found beside the scene when empty, \"none\" for an orbit.");
        f("model", self.model, "Diffusers folder or .safetensors checkpoint; empty = the starter model.");
        f("device", self.device, "Where the networks run: cpu or cuda.");
        f("threads", self.threads, "Threads of the networks; small ones gain nothing from more. Another number may round differently.", Range{1, 256});
        f("up", self.up, "World up: auto, x, y, z, -x, -y or -z.");
        f("front", self.front,
          "Azimuth in degrees from which the scene shows its front; lets the model be told \"front view\" and so on.");
        f("turntable_size", self.turntable_size, "Side of each half of the before/after film in pixels.",
          Range{16, 4096});
        f("turntable_frames", self.turntable_frames, "Frames of the before/after film.", Range{1, 10000});
    }
};

/// Everything that decides the result.
struct EditRecipe {
    JobParameters job;
    edit::EditRequest request;
    neural::SdsParameters guidance;
    bool use_dreambooth = false;   // the model learns the scene first (method S2)
    neural::DreamBoothParameters dreambooth;
};

/// {"version", "job", "request", "guidance"} and, where it is used, "dreambooth"; reading throws Error for unknown or
/// wrong entries. A relative scene path is taken relative to the recipe's folder.
nlohmann::ordered_json recipe_to_json(const EditRecipe& recipe);
EditRecipe read_recipe(const std::filesystem::path& path);

/// Seconds per stage, in order of first use.
class StageTimes {
public:
    void begin(const std::string& stage);
    void end();
    nlohmann::ordered_json to_json() const;

private:
    std::vector<std::pair<std::string, double>> stages_;
    std::string open_;
    double start_ = 0;
};

/// What a job works on when it is in memory already.
struct EditJobInput {
    Scene scene;
    std::vector<View> cameras;                     // empty = an orbit is fitted
    std::shared_ptr<neural::TextToImage> model;
};

/// The guidance's settings with the sentence before the edit, worked out from the request where none is given.
neural::SdsParameters with_sentence_before(neural::SdsParameters guidance, const edit::EditRequest& request);

/// Callbacks of a running edit; all may be empty.
struct EditObserver {
    edit::SnapshotCallback snapshot;
    double snapshot_seconds = 0;   // above 0: time between snapshots, instead of the request's iterations
    edit::IterationCallback iteration;
    std::function<std::optional<std::vector<std::uint8_t>>()> new_label;   // see edit::EditTools
};

/// The model a recipe names (the starter when it names none). Throws Error (Model, NotFound).
std::shared_ptr<neural::TextToImage> load_recipe_model(const JobParameters& job);

/// A scene with its model and views, ready to be edited.
class EditJob {
public:
    /// Checks the request, reads the scene, loads the model, chooses the views. Throws Error before anything is written.
    EditJob(EditRecipe recipe, JobControl control);
    /// The same for what is in memory; the recipe's files are not read.
    EditJob(EditRecipe recipe, EditJobInput input, JobControl control);

    /// DreamBooth: the model learns the scene from renders of its views, for as long as this job lives. locate() begins
    /// with it when the recipe asks for it.
    void tune();
    /// Looks from all views, moves in on what was found, looks again.
    void locate();
    /// The same from the views chosen already, with another attention threshold; networks are asked only about pictures
    /// they have not seen.
    void locate_again(double attention_threshold);
    /// What may change, corrected by hand (modify mode): [N] 0 or 1.
    void correct_label(const std::vector<std::uint8_t>& bits);
    /// For words that no view shows: no masks, the label given to correct_label() alone says what may change.
    void use_label_alone();
    /// Runs the edit loop.
    void run(const EditObserver& observer = {});
    /// Replaces where to report and what stops (a job that located goes on to edit).
    void set_control(JobControl control) { control_ = std::move(control); }
    /// Takes the loop's settings (iterations, weights, rates, seed) of another request; words and views stay.
    void set_loop_settings(const edit::EditRequest& request);

    const EditRecipe& recipe() const { return recipe_; }
    const Scene& scene() const { return scene_; }
    const std::vector<View>& views() const { return views_; }
    const edit::LocateResult& located() const { return located_; }
    const edit::EditPlan& plan() const { return plan_; }
    const edit::EditResult& result() const { return result_; }
    /// What tune() did, if it ran.
    const std::optional<neural::TuneReport>& tuning() const { return tuning_; }
    /// "front view" and so on per view, or empty.
    const std::vector<std::string>& view_words() const { return view_words_; }
    /// How views are rendered.
    raster::Settings render_settings() const;
    /// The recipe's prompt as the model is told it.
    std::string model_prompt() const;
    /// Orbit around what was edited, for films.
    OrbitParameters film_orbit() const;
    neural::TextToImage& model() { return *model_; }
    Painter& painter() { return painter_; }
    StageTimes& times() { return times_; }
    const JobControl& control() const { return control_; }

private:
    void check_recipe();
    void begin(std::vector<View> cameras);
    void choose_views(std::vector<View> cameras);
    void set_orbit_views();
    void name_views();
    void choose_distance(const edit::LocateTools& tools);
    void finish_locate();
    std::string dynamic_word() const;
    edit::LocateInput locate_input() const;
    std::vector<Image> instance_pictures();

    EditRecipe recipe_;
    JobControl control_;
    StageTimes times_;
    Painter painter_;
    Scene scene_;
    std::shared_ptr<neural::TextToImage> model_;
    std::unique_ptr<edit::CachedAttention> attention_;
    std::vector<View> views_;
    std::vector<std::string> view_words_;
    bool automatic_views_ = false;
    OrbitParameters orbit_;
    edit::LocateResult located_;
    edit::EditPlan plan_;
    edit::EditResult result_;
    std::optional<neural::TuneReport> tuning_;
    std::shared_ptr<void> untune_;   // gives the model its own weights back when the job ends
};

/// Where the starter model is: beside the sources, or installed.
std::filesystem::path starter_model_path();
std::filesystem::path assets_path();

/// Warns about words the model was not trained on and suggests the nearest known ones.
void warn_unknown_words(const std::vector<std::string>& words, const std::vector<std::string>& known);

}  // namespace gse::app
