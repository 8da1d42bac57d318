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

#include "engine/edit/cached_attention.h"
#include "engine/edit/locate.h"
#include "engine/edit/session.h"
#include "engine/neural/api.h"
#include "engine/pipeline/installed.h"
#include "engine/pipeline/model_words.h"
#include "engine/pipeline/recipe.h"
#include "engine/pipeline/scene_tools.h"
#include "engine/pipeline/stage_times.h"

namespace gse::pipeline {

/// What a job works on when it is in memory already.
struct EditJobInput {
    Scene scene;
    std::vector<View> cameras;                     // empty = an orbit is fitted
    std::shared_ptr<neural::TextToImage> model;
    std::vector<std::uint8_t> label = {};          // [N] made by hand: says where when the words do not; empty = none
    std::vector<std::string> view_words = {};      // one for each of `cameras` where it is known; else from the recipe's front
    std::optional<neural::TunedModel> tuned = {};  // what another job learned of this scene for these words and settings
    std::vector<std::string> said = {};            // words that the scene is known to show: no news
};

/// The guidance's settings with the sentence before the edit, worked out from the request where none is given.
neural::SdsParameters with_sentence_before(neural::SdsParameters guidance, const edit::EditRequest& request);

/// Callbacks of a running edit; all may be empty.
struct EditObserver {
    edit::SnapshotCallback snapshot;
    double snapshot_seconds = 0;   // above 0: time between snapshots, instead of the request's iterations
    edit::IterationCallback iteration;
    std::optional<edit::EditSnapshot> start = {};   // goes on from there
    std::function<std::optional<std::vector<std::uint8_t>>()> new_label;   // see edit::EditTools
};

/// The model a recipe names (the starter when it names none). Throws Error (Model, NotFound).
std::shared_ptr<neural::TextToImage> load_recipe_model(const JobParameters& job);

/// Sets how many threads the networks take, for a model that is loaded already.
void use_threads(const JobParameters& job);

/// A scene with its model and views, ready to be edited.
class EditJob {
public:
    /// Checks the request, reads the scene, loads the model, chooses the views. Throws Error before anything is written.
    EditJob(EditRecipe recipe, JobControl control);
    /// The same for what is in memory; the recipe's files are not read.
    EditJob(EditRecipe recipe, EditJobInput input, JobControl control);

    /// DreamBooth: from here on this job works with a model of its own, which learned the scene from renders of its views.
    /// locate() begins with it when the recipe asks for it.
    void tune();
    /// Works out which word is new where the recipe does not say, looks from all views, moves in on what was found, looks again. With a label made by hand, a word that the model does
    /// not know is not looked for, and one that is not found does no harm. A search that comes to nothing is a result too:
    /// see found().
    void locate();
    /// Whether something may change: located().problem says why not.
    bool found() const { return located_.problem == edit::SearchProblem::None; }
    /// Labels what an unsure search found all the same.
    void locate_anyway();
    /// The same from the views chosen already, with another attention threshold: no network is asked anything.
    void locate_again(double attention_threshold);
    /// The attention threshold in force: the request's, or what the model states.
    double attention_threshold() const;
    /// What may change, corrected by hand (modify mode): [N] 0 or 1.
    void correct_label(const std::vector<std::uint8_t>& bits);
    /// For words that no view shows: this label alone says what may change, [N] 0 or 1.
    void use_label(const std::vector<std::uint8_t>& bits);
    /// Runs the edit loop.
    void run(const EditObserver& observer = {});
    /// Runs that many plain steps of the loop, for their time; result() is of them until run() replaces it.
    void probe(int steps);
    /// Replaces where to report and what stops (a job that located goes on to edit).
    void set_control(JobControl control) { control_ = std::move(control); }
    /// Takes the settings of the loop and of the guidance, and the label's thresholds, of a recipe with the same search_key():
    /// no network is asked. `relabels` = false: an artist's own label is used, which follows no share of the votes.
    void take_settings(const EditRecipe& recipe, bool relabels = true);

    const EditRecipe& recipe() const { return recipe_; }
    const Scene& scene() const { return scene_; }
    /// The scene and the result as pictures and figures are made from them: without what cannot be drawn.
    const GaussianSet& drawn() const { return drawn_; }
    const GaussianSet& drawn_result() const { return drawn_result_; }
    /// Splats of the scene that cannot be drawn; the edit leaves them as they are.
    std::size_t unusable() const { return unusable_; }
    const std::vector<View>& views() const { return views_; }
    const edit::LocateResult& located() const { return located_; }
    const edit::EditPlan& plan() const { return plan_; }
    const edit::EditResult& result() const { return result_; }
    /// What was learned of the scene, if anything was.
    const std::optional<neural::TuneReport>& tuning() const { return tuning_; }
    /// The same with the model that learned it, for another job.
    std::optional<neural::TunedModel> tuned() const;
    /// "front view" and so on per view, or empty.
    const std::vector<std::string>& view_words() const { return view_words_; }
    /// How views are rendered.
    raster::Settings render_settings() const;
    /// The recipe's prompt as the model is told it.
    std::string model_prompt() const;
    /// Pictures that the search has asked the networks about so far.
    std::size_t questions() const { return attention_ ? attention_->asked() : 0; }
    /// Whether the pictures said which word is new, and not the recipe.
    bool target_read() const { return target_read_; }
    bool automatic_views() const { return automatic_views_; }
    /// Orbit around what was edited, for films.
    OrbitParameters film_orbit() const;
    neural::TextToImage& model() { return *model_; }
    Painter& painter() { return painter_; }
    StageTimes& times() { return times_; }
    const JobControl& control() const { return control_; }

private:
    void check_recipe();
    void check_length() const;
    void begin(std::vector<View> cameras);
    void choose_views(std::vector<View> cameras);
    void set_orbit_views();
    void name_views();
    void read_scene();
    std::vector<Image> pictures_of(const std::vector<View>& views);
    void choose_distance(const OrbitParameters& fitted, const std::vector<double>& distances, const edit::LocateTools& tools);
    void look_and_move_in(bool moves, const edit::LocateTools& tools);
    void search(const edit::LocateTools& tools);
    void look_again();
    void label_only_what_was_found();
    void finish_locate();
    edit::LocateTools locate_tools();
    void run_loop(const edit::EditRequest& request, const EditObserver& observer, const JobControl& control);
    std::string dynamic_word() const;
    edit::LocateInput locate_input() const;
    std::vector<Image> instance_pictures();

    EditRecipe recipe_;
    JobControl control_;
    StageTimes times_;
    Painter painter_;
    Scene scene_;
    GaussianSet drawn_, drawn_result_;
    std::size_t unusable_ = 0;
    std::shared_ptr<neural::TextToImage> model_;
    std::unique_ptr<edit::CachedAttention> attention_;
    edit::ViewMemory memory_;
    std::unique_ptr<edit::Segmenter> segmenter_;
    ThreadPool threads_;
    std::unique_ptr<edit::Recognition> recognition_;
    bool target_open_ = false;          // the recipe leaves it to the pictures which word is new
    bool target_read_ = false;          // they have said it
    std::vector<double> distances_;     // shares of the fitted orbit's radius that the search tries
    std::vector<std::string> said_;     // words the scene is known to show
    std::vector<std::uint8_t> label_;   // made by hand, or empty
    bool by_label_ = false;             // it was used
    std::vector<View> views_;
    std::vector<std::string> view_words_;
    std::map<std::string, std::string> given_words_;   // of cameras, by name
    bool automatic_views_ = false;
    OrbitParameters orbit_;
    edit::LocateResult located_;
    edit::EditPlan plan_;
    bool plan_stale_ = false;        // the label moved on; made anew when the loop needs it
    edit::EditResult result_;
    std::optional<neural::TuneReport> tuning_;
};

/// Warns about words the model was not trained on and suggests the nearest known ones.
void warn_unknown_words(const std::vector<std::string>& words, const std::vector<std::string>& known);

}  // namespace gse::pipeline
