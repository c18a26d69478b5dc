using System.IO;
using UnrealBuildTool;

/// The components.
public class Pacinian : ModuleRules
{
    public Pacinian(ReadOnlyTargetRules Target) : base(Target)
    {
        PCHUsage = PCHUsageMode.UseExplicitOrSharedPCHs;
        bUseUnity = false; // files use equal names in anonymous namespaces
        bEnableExceptions = false;
        bUseRTTI = false;
        PublicDependencyModuleNames.AddRange(new string[] { "Core", "CoreUObject", "Engine", "DeveloperSettings" });
        PrivateDependencyModuleNames.AddRange(new string[] { "HeadMountedDisplay", "InputCore", "PacinianCore", "PhysicsCore", "Projects", "RenderCore", "RHI" });
        string Server = Path.Combine(PluginDirectory, "Server", "pacinian"); // the standalone server, if present
        if (Directory.Exists(Server))
        {
            RuntimeDependencies.Add("$(PluginDir)/Server/pacinian/...");
        }
    }
}
