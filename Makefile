# SPDX-License-Identifier: Apache-2.0
# `make help` lists the targets. Every target sets up what it needs and is quick when nothing changed.
SHELL := /bin/bash
.DEFAULT_GOAL := help
PYTHON ?= python3
VENV := .venv
RUN := tools/in_workspace

.PHONY: help setup demo test soak-tests lint lint-docker clean lock peers train-visual data-masks train-masks record eval-perception eval-photo fit-probability fit-name-sets eval-visual eval-tasks eval-faults eval-disturbances eval-doubt eval-replay bench-motion bench-obstacles bench-refusals bench-trajectories bench-execution bench-planner bench-stability bench-sim bench-perception data-latent train-latent eval-latent eval-latent-qa eval-latent-tasks results reference

help:  ## this list
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## */  \1\t/' | expand -t 20

setup:  ## virtual environment and workspace, built where something changed; TORCH_BACKEND=cpu
	@TORCH_BACKEND="$(TORCH_BACKEND)" tools/setup "$(PYTHON)"

demo: setup  ## build a tower; SEED= BLOCKS= GOAL= OUT= RTF=
	@$(RUN) ros2 run tamp_bringup demo $(if $(SEED),--seed $(SEED)) $(if $(BLOCKS),--blocks $(BLOCKS)) \
	  $(if $(GOAL),--goal "$(GOAL)") $(if $(OUT),--out "$(OUT)") $(if $(RTF),--real-time-factor $(RTF))

lint: setup lint-docker  ## ruff, mypy and hadolint
	@$(VENV)/bin/ruff check .
	@$(VENV)/bin/ruff format --check .
	@$(RUN) mypy

lint-docker: setup  ## hadolint on the Dockerfile; nothing is built
	@$(VENV)/bin/hadolint docker/Dockerfile

test: setup  ## the whole test suite
	@$(RUN) pytest --numprocesses 3 --dist loadfile $(ARGS)

soak-tests: setup  ## the suite again and again, half of them on a busy machine; RUNS= RESUME=1 QUICK=1
	@$(RUN) python benchmarks/suite.py $(if $(RUNS),--runs $(RUNS)) $(if $(RESUME),--resume)

train-visual: setup  ## train the visual module G without labels; resumable
	@$(RUN) ros2 run sim_node render_dataset --out data/states_5 --blocks 5
	@$(RUN) ros2 run perception_node train_visual --data data/states_5 $(ARGS)

data-masks: setup  ## pictures to train the masks from colour alone; resumable; ARGS=
	@$(RUN) python benchmarks/render_masks.py $(ARGS)

train-masks: setup  ## train the network that finds blocks in colour alone; resumable; ARGS=
	@$(RUN) python benchmarks/render_masks.py
	@$(RUN) ros2 run perception_node train_masks $(ARGS)

record: setup  ## perception_node on your camera, whose pictures are kept for training; OUT= ARGS="-r camera/image_raw:=…"
	@$(RUN) ros2 run perception_node perception_node --ros-args -p record:=$(or $(OUT),data/recorded) $(ARGS)

data-latent: setup  ## pictures, transitions and questions of Chapter 4; resumable; ARGS=
	@$(RUN) python benchmarks/render_latent.py $(ARGS)

train-latent: setup  ## state encoder and action models of Chapter 4; resumable; SEED= ARGS=
	@$(RUN) python benchmarks/train_latent.py $(if $(SEED),--seed $(SEED) --run runs/latent/$(SEED)) $(ARGS)

eval-latent: setup  ## codes, action models and planning on codes, all seeds that were trained; N= QUICK=1
	@$(RUN) python benchmarks/eval_latent.py $(if $(N),--n $(N)) $(ARGS)

eval-latent-qa: setup  ## questions about scenes, eq. 4.2 in its three settings; trains what is missing, resumable; ARGS=
	@$(RUN) python benchmarks/eval_latent_qa.py $(ARGS)

eval-latent-tasks: setup  ## goal images met in the simulator with representation latent; N= QUICK=1
	@$(RUN) python benchmarks/eval_latent_tasks.py $(if $(N),--n $(N))

eval-perception: setup  ## graphs right, accepted and refused, set by set; SET= N= JOBS= RESUME=1 QUICK=1
	@$(RUN) python benchmarks/eval_perception.py $(if $(SET),--set "$(SET)") $(if $(N),--n $(N)) \
	  $(if $(JOBS),--jobs $(JOBS)) $(if $(RESUME),--resume) $(ARGS)

eval-photo: setup  ## graphs of photorealistic pictures; BPY=venv with bpy N= QUICK=1
	@$(RUN) python benchmarks/eval_photo.py $(if $(N),--n $(N)) $(if $(BPY),--bpy "$(BPY)") $(ARGS)

fit-probability: setup  ## the probability that a graph is right, seeds 100 to 999; N=
	@$(RUN) python benchmarks/fit_probability.py $(if $(N),--n $(N))

fit-name-sets: setup  ## sets of colours that hold the right ones, seeds 100 to 999; COVERAGE= N=
	@$(RUN) python benchmarks/fit_name_sets.py $(if $(COVERAGE),--coverage $(COVERAGE)) $(if $(N),--n $(N))

eval-visual: setup  ## the visual module with masks given, on unseen states; QUICK=1
	@$(RUN) python benchmarks/eval_visual.py $(ARGS)

eval-tasks: setup  ## success from pixels to tower; FAMILY=six|seven|varied|… N= JOBS= RTF= RESUME=1 SEED= QUICK=1 BASELINE=, BLOCKS=6 is FAMILY=six
	@$(RUN) python benchmarks/eval_tasks.py $(if $(FAMILY),--family "$(FAMILY)") $(if $(N),--n $(N)) \
	  $(if $(BLOCKS),--blocks $(BLOCKS)) $(if $(SEED),--seed $(SEED)) $(if $(RTF),--real-time-factor $(RTF)) \
	  $(if $(JOBS),--jobs $(JOBS)) $(if $(RESUME),--resume) $(if $(BASELINE),--baseline "$(BASELINE)")

eval-faults: setup  ## faults of every kind in every phase, and what becomes of the task; ONLY= PHASE= SEED= TRIALS= JOBS= RTF= RESUME=1 QUICK=1
	@$(RUN) python benchmarks/eval_faults.py $(if $(ONLY),--only "$(ONLY)") $(if $(PHASE),--phase $(PHASE)) \
	  $(if $(SEED),--seed $(SEED)) $(if $(TRIALS),--trials $(TRIALS)) $(if $(RTF),--real-time-factor $(RTF)) \
	  $(if $(JOBS),--jobs $(JOBS)) $(if $(RESUME),--resume) $(ARGS)

eval-disturbances: setup  ## tasks disturbed at random moments, and undisturbed ones; VERIFY=end|each_move|watch N= QUIET= MINUTES= KIND= SEED= JOBS= RTF= RESUME=1 QUICK=1
	@$(RUN) python benchmarks/eval_disturbances.py $(if $(KIND),--kind "$(KIND)") $(if $(VERIFY),--verify "$(VERIFY)") \
	  $(if $(N),--n $(N)) $(if $(QUIET),--quiet $(QUIET)) $(if $(MINUTES),--minutes $(MINUTES)) $(if $(SEED),--seed $(SEED)) $(if $(RTF),--real-time-factor $(RTF)) \
	  $(if $(JOBS),--jobs $(JOBS)) $(if $(RESUME),--resume) $(ARGS)

eval-doubt: setup  ## tasks beside a block between two colours: done, asked, refused; N= QUICK=1
	@$(RUN) python benchmarks/eval_doubt.py $(if $(N),--n $(N))

eval-replay: setup  ## executed tasks once more in MuJoCo; N= BLOCKS= SOURCE=graph|process RTF= SEED= RESUME=1 QUICK=1
	@$(RUN) python benchmarks/eval_replay.py $(if $(N),--n $(N)) $(if $(BLOCKS),--blocks $(BLOCKS)) $(if $(SOURCE),--source $(SOURCE)) \
	  $(if $(RTF),--real-time-factor $(RTF)) $(if $(SEED),--seed $(SEED)) $(if $(RESUME),--resume) $(ARGS)

bench-sim: setup  ## time of pictures and of the whole graph, pictures against the physics' rays; QUICK=1
	@$(RUN) python benchmarks/bench_sim.py

bench-perception: setup  ## from a picture to its graph in the running graph, in real time; N= RESUME=1 QUICK=1
	@$(RUN) python benchmarks/bench_perception.py $(if $(N),--n $(N)) $(if $(RESUME),--resume) $(ARGS)

bench-motion: setup  ## time to find motions, and how long they take; PEERS=venv with robotic and toppra QUICK=1
	@$(RUN) python benchmarks/bench_motion.py $(if $(PEERS),--peers "$(PEERS)")

bench-obstacles: setup  ## goals among walls, narrow places and places out of reach; QUICK=1
	@$(RUN) python benchmarks/bench_obstacles.py

bench-refusals: setup  ## moves that cannot be: whether the reason is right, and what would help; RESUME=1 QUICK=1
	@$(RUN) python benchmarks/bench_refusals.py $(if $(RESUME),--resume)

bench-trajectories: setup  ## a thousand random plans beside meshes, a sampler and other starts; RESUME=1 QUICK=1
	@$(RUN) python benchmarks/bench_trajectories.py $(if $(RESUME),--resume)

bench-execution: setup  ## random moves and stops in the simulator's world: where blocks end; RESUME=1 QUICK=1
	@$(RUN) python benchmarks/bench_execution.py $(if $(RESUME),--resume)

bench-planner: setup  ## search times, lengths and bounds; FD=venv with up-fast-downward QUICK=1
	@$(RUN) python benchmarks/bench_planner.py $(if $(FD),--fd "$(FD)")

bench-stability: setup  ## plans for spheres, prisms and mixed sizes, beside brute force; QUICK=1
	@$(RUN) python benchmarks/bench_stability.py

results: setup  ## docs/results.md from the result files
	@$(RUN) python benchmarks/write_results_page.py

reference: setup  ## docs/parameters.md and docs/interfaces.md from the sources
	@$(RUN) python tools/write_reference.py

peers: setup  ## Unified Planning, Fast Downward and pyperplan as back ends: search_algorithm up:ENGINE
	@VIRTUAL_ENV=$(VENV) $(VENV)/bin/uv pip install --require-hashes --no-deps -r requirements-peers.lock

lock:  ## compile requirements.in to the hash-pinned requirements.lock
	@tools/lock

clean:  ## remove the environment and everything built; runs and data stay
	rm -rf $(VENV) ros_ws/build ros_ws/install ros_ws/log .mypy_cache .ruff_cache .hypothesis
