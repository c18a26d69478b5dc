using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine
{
    /// <summary>Calls messages by name, as Unity does, even if they are private.</summary>
    public class MonoBehaviour : Behaviour
    {
        private static readonly HashSet<string> Parameterless = new HashSet<string>
        {
            "Awake", "Start", "OnEnable", "OnDisable", "OnDestroy", "Update", "LateUpdate", "OnApplicationQuit",
            "OnDrawGizmos", "OnDrawGizmosSelected", "OnValidate", "Reset",
        };

        private readonly Dictionary<string, Action> _messages = new Dictionary<string, Action>();
        private bool _awake;

        internal int Order
        {
            get
            {
                object[] found = GetType().GetCustomAttributes(typeof(DefaultExecutionOrder), true);
                return found.Length == 0 ? 0 : ((DefaultExecutionOrder)found[0]).order;
            }
        }

        internal bool On { get; private set; }

        internal bool Started { get; set; }

        public void SendMessage(string message)
        {
            Send(message);
        }

        /// <summary>Calls a message if the class has it.</summary>
        internal void Send(string message)
        {
            Action action;
            if (!_messages.TryGetValue(message, out action))
            {
                action = Find(message);
                _messages.Add(message, action);
            }
            if (action != null)
            {
                action();
            }
        }

        internal override void Changed()
        {
            if (!Engine.Playing || Destroyed)
            {
                return;
            }
            if (!_awake && gameObject.activeInHierarchy)
            {
                _awake = true;
                Engine.Add(this);
                Send("Awake");
            }
            if (_awake && On != isActiveAndEnabled)
            {
                On = !On;
                Send(On ? "OnEnable" : "OnDisable");
            }
        }

        private Action Find(string message)
        {
            const BindingFlags All = BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.DeclaredOnly;
            for (Type type = GetType(); type != typeof(MonoBehaviour); type = type.BaseType)
            {
                foreach (MethodInfo method in type.GetMethods(All))
                {
                    if (Parameterless.Contains(method.Name) && method.GetParameters().Length > 0)
                    {
                        throw new InvalidOperationException(type + "." + method.Name + " can not take parameters");
                    }
                    if (method.Name == message)
                    {
                        return (Action)Delegate.CreateDelegate(typeof(Action), this, method);
                    }
                }
            }
            return null;
        }
    }
}
